"""Verifiers that put the question to an SMV engine, and check the engine's counterexamples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vaso.ltl import Formula
from vaso.plan.atoms import AtomTables
from vaso.plan.export import SmvModel, to_smv
from vaso.plan.transition_system import TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers.base import Answer, Lasso
from vaso.verifiers.engine import SMVAnswer, SMVEngine, SMVTrace
from vaso.verifiers.reduction import reduce
from vaso.verifiers.runs import follow, objection
from vaso.verifiers.shortening import shorten
from vaso.verifiers.support import not_total, readable

__all__ = ["SMVVerifier"]


class SMVVerifier:
    """Decides formulas with an SMV engine.

    The system is reduced to what the formulas can see, written as one model, and loaded once. A
    counterexample is trusted only as a sequence of sensor values: it is followed on the full
    system, replayed step by step, and the formula is evaluated on it without the engine.

    Args:
        engine: The engine.
    """

    def __init__(self, engine: SMVEngine) -> None:
        self.engine = engine
        self.name = engine.name

    def check(
        self,
        system: TransitionSystem,
        formulas: Sequence[Formula],
        *,
        timeout: float = 60.0,
        counterexamples: bool = True,
    ) -> list[Answer]:
        """Check formulas on one system; see :class:`~vaso.verifiers.base.Verifier`.

        Raises:
            VerifierError: The engine is not installed.
        """
        refused = not_total(system, formulas, self.name)
        if refused:
            return refused
        tables = AtomTables(system)
        sound, answers = readable(tables, formulas, self.name)
        if sound:
            asked = [formulas[i] for i in sound]
            model = to_smv(reduce(system, asked, tables), asked)
            found = self.engine.check(
                model.text, model.specs, timeout=timeout, traces=counterexamples
            )
            judge = _Judge(system, model, self.name, counterexamples)
            for index, answer in zip(sound, found, strict=True):
                answers[index] = judge.answer(formulas[index], answer)
        return [answers[i] for i in range(len(formulas))]


@dataclass(frozen=True, slots=True)
class _Judge:
    """Turns an engine's answers into verdicts on the full system."""

    system: TransitionSystem
    model: SmvModel
    name: str
    counterexamples: bool

    def answer(self, formula: Formula, found: SMVAnswer) -> Answer:
        if found.holds is None:
            return Answer(Verdict.UNKNOWN, self.name, found.seconds, reason=found.reason)
        if found.holds:
            return Answer(Verdict.PASS, self.name, found.seconds)
        if not self.counterexamples:
            return Answer(Verdict.FAIL, self.name, found.seconds)
        if found.trace is None:
            return self._unconfirmed(found, found.reason or "it gave no trace")
        lasso = self._decode(found.trace)
        doubt = objection(self.system, lasso, formula)
        if doubt:
            return self._unconfirmed(found, doubt)
        lasso = shorten(self.system, lasso, formula)
        return Answer(Verdict.FAIL, self.name, found.seconds, lasso)

    def _decode(self, trace: SMVTrace) -> Lasso:
        values = [self.model.valuation(step.values) for step in trace.steps]
        lasso = follow(self.system, values[: trace.loop_start], values[trace.loop_start :])
        assert lasso is not None  # without a limit, a run of a finite system closes
        return lasso

    def _unconfirmed(self, found: SMVAnswer, doubt: str) -> Answer:
        reason = f"{self.name} reports a violation, but its run is not confirmed: {doubt}"
        return Answer(Verdict.UNKNOWN, self.name, found.seconds, reason=reason)
