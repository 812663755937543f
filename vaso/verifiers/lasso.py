"""Direct evaluation for plans that have only one behaviour: no model checker, linear time."""

from __future__ import annotations

import time
from collections.abc import Sequence
from collections.abc import Set as AbstractSet

from vaso.errors import FormulaError
from vaso.ltl import Formula, holds
from vaso.plan.atoms import names_of
from vaso.plan.transition_system import TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers.base import Answer, Lasso
from vaso.verifiers.reduction import reduce
from vaso.verifiers.runs import follow
from vaso.verifiers.support import not_total

__all__ = ["LassoVerifier"]

_BRANCHING = "the plan has more than one behaviour as far as this formula can see"
_SENSORS = "the formula depends on sensors, which are free in every step"


class LassoVerifier:
    """Evaluates formulas on the one run of a system.

    It covers formulas that see only one behaviour: every control path gives their propositions
    the same values, and none of these depends on a sensor. Trajectories are of this kind. Other
    formulas are answered UNSUPPORTED.
    """

    name = "lasso"

    def check(
        self,
        system: TransitionSystem,
        formulas: Sequence[Formula],
        *,
        timeout: float = 60.0,
        counterexamples: bool = True,
    ) -> list[Answer]:
        """Check formulas on one system; see :class:`~vaso.verifiers.base.Verifier`."""
        refused = not_total(system, formulas, self.name)
        if refused:
            return refused
        run = follow(system, (), ({},))
        assert run is not None  # without a limit, a run of a finite system closes
        observed = {n for state, _ in run.run for n in system.states[state].observed}
        return [self._check(system, run, observed, f, counterexamples) for f in formulas]

    def _check(
        self,
        system: TransitionSystem,
        run: Lasso,
        observed: AbstractSet[str],
        formula: Formula,
        counterexamples: bool,
    ) -> Answer:
        started = time.perf_counter()
        verdict, reason = _decide(system, run, observed, formula)
        seconds = time.perf_counter() - started
        lasso = run if counterexamples and verdict is Verdict.FAIL else None
        return Answer(verdict, self.name, seconds, lasso, reason)


def _decide(
    system: TransitionSystem, run: Lasso, observed: AbstractSet[str], formula: Formula
) -> tuple[Verdict, str]:
    if names_of(formula) & observed:
        return Verdict.UNSUPPORTED, _SENSORS
    try:
        if not system.is_deterministic and not reduce(system, [formula]).is_deterministic:
            return Verdict.UNSUPPORTED, _BRANCHING
        labels = [system.states[state].labels for state, _ in run.run]
        return (Verdict.PASS if holds(formula, labels, run.loop_start) else Verdict.FAIL), ""
    except FormulaError as error:
        return Verdict.UNSUPPORTED, str(error)
