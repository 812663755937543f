"""Verifiers that put the question to an SMV engine, and check the engine's counterexamples."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

from vaso.ltl import Formula
from vaso.plan.atoms import AtomTables
from vaso.plan.export import to_smv
from vaso.plan.transition_system import TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers.base import Answer, Lasso
from vaso.verifiers.engine import SMVAnswer, SMVEngine, SMVTrace
from vaso.verifiers.reduction import reduce
from vaso.verifiers.runs import confirmed, follow, objection
from vaso.verifiers.shortening import shorten
from vaso.verifiers.support import not_total, readable
from vaso.verifiers.witness import find_violation

__all__ = ["SMVVerifier"]


class SMVVerifier:
    """Decides formulas with an SMV engine.

    The system is reduced to what the formulas can see, written as one model, and loaded once. For
    a formula that fails, a violating run is searched on the explicit automaton, and where that
    finds none the engine is asked for its trace. Either is trusted only as a sequence of sensor
    values: it is followed on the full system, replayed step by step, and the formula is evaluated
    on it without the engine.

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
            task = _Task(system, reduce(system, asked, tables), asked, self.engine)
            found = task.answers(time.monotonic() + timeout, counterexamples)
            answers.update(zip(sound, found, strict=True))
        return [answers[i] for i in range(len(formulas))]


class _Task:
    """Formulas on one system: verdicts by the engine, runs from wherever they can be had."""

    def __init__(
        self,
        system: TransitionSystem,
        reduced: TransitionSystem,
        formulas: Sequence[Formula],
        engine: SMVEngine,
    ) -> None:
        self.system, self.reduced = system, reduced
        self.formulas, self.engine = formulas, engine
        self.model = to_smv(reduced, formulas)

    def answers(self, deadline: float, counterexamples: bool) -> list[Answer]:
        found = self._ask(range(len(self.formulas)), deadline, traces=False)
        answers = [self._verdict(a) for a in found]
        if not counterexamples:
            return answers
        failed = [i for i, a in enumerate(answers) if a.verdict is Verdict.FAIL]
        for index in failed:
            answers[index] = replace(answers[index], lasso=self._search(self.formulas[index]))
        left = [i for i in failed if answers[i].lasso is None]
        for index, traced in zip(left, self._ask(left, deadline, traces=True), strict=True):
            answers[index] = self._confirmed(index, answers[index], traced)
        return answers

    def _ask(self, indices: Sequence[int], deadline: float, *, traces: bool) -> list[SMVAnswer]:
        if not indices:
            return []
        specs = [self.model.specs[i] for i in indices]
        left = max(0.0, deadline - time.monotonic())
        return self.engine.check(self.model.text, specs, timeout=left, traces=traces)

    def _verdict(self, found: SMVAnswer) -> Answer:
        if found.holds is None:
            verdict = Verdict.UNKNOWN
        else:
            verdict = Verdict.PASS if found.holds else Verdict.FAIL
        return Answer(verdict, self.engine.name, found.seconds, reason=found.reason)

    # --- counterexamples -----------------------------------------------------------------------

    def _search(self, formula: Formula) -> Lasso | None:
        """A violating run from the explicit automaton."""
        word = find_violation(reduce(self.reduced, [formula]), formula)
        lasso = None if word is None else confirmed(self.system, word, formula)
        return None if lasso is None else shorten(self.system, lasso, formula)

    def _confirmed(self, index: int, answer: Answer, traced: SMVAnswer) -> Answer:
        """A violating run from the engine's trace; without one, there is no verdict."""
        formula, seconds = self.formulas[index], answer.seconds + traced.seconds
        lasso = None if traced.trace is None else self._decode(traced.trace)
        if lasso is None:
            doubt = traced.reason or "it gave no trace"
        else:
            doubt = objection(self.system, lasso, formula)
        if lasso is not None and not doubt:
            return replace(answer, seconds=seconds, lasso=shorten(self.system, lasso, formula))
        reason = f"{answer.engine} reports a violation, but its run is not confirmed: {doubt}"
        return Answer(Verdict.UNKNOWN, answer.engine, seconds, reason=reason)

    def _decode(self, trace: SMVTrace) -> Lasso | None:
        values = [self.model.valuation(step.values) for step in trace.steps]
        return follow(self.system, values[: trace.loop_start], values[trace.loop_start :])
