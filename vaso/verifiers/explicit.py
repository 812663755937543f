"""Model checking on the explicit automaton: no NuSMV, no BDDs, and no code shared with them."""

from __future__ import annotations

import time
from collections.abc import Sequence

from vaso.ltl import Formula, has_past
from vaso.plan.atoms import AtomTables
from vaso.plan.transition_system import TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers.base import Answer, Lasso
from vaso.verifiers.reduction import reduce
from vaso.verifiers.runs import confirmed
from vaso.verifiers.shortening import shorten
from vaso.verifiers.support import not_total, readable
from vaso.verifiers.witness import UndecidedError, search

__all__ = ["ExplicitVerifier"]


class ExplicitVerifier:
    """Decides formulas by searching the product of the plan and the negated formula.

    It is an independent second opinion on the model checker, and the quickest engine for small
    reactive plans. Formulas with past operators are UNSUPPORTED; a search that grows too large is
    UNKNOWN. A violation is replayed on the plan and evaluated again before it is returned.
    """

    name = "explicit"

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
        tables = AtomTables(system)
        sound, answers = readable(tables, formulas, self.name)
        deadline = time.monotonic() + timeout
        for index in sound:
            if time.monotonic() > deadline:
                answers[index] = Answer(Verdict.UNKNOWN, self.name, reason="time-out")
            else:
                answers[index] = self._check(system, formulas[index], tables, counterexamples)
        return [answers[i] for i in range(len(formulas))]

    def _check(
        self,
        system: TransitionSystem,
        formula: Formula,
        tables: AtomTables,
        counterexamples: bool,
    ) -> Answer:
        started = time.perf_counter()
        verdict, lasso, reason = self._decide(system, formula, tables)
        if lasso is not None:
            lasso = shorten(system, lasso, formula) if counterexamples else None
        return Answer(verdict, self.name, time.perf_counter() - started, lasso, reason)

    def _decide(
        self, system: TransitionSystem, formula: Formula, tables: AtomTables
    ) -> tuple[Verdict, Lasso | None, str]:
        if has_past(formula):
            return Verdict.UNSUPPORTED, None, "the formula looks back in time"
        try:
            word = search(reduce(system, [formula], tables), formula)
        except UndecidedError as error:
            return Verdict.UNKNOWN, None, str(error)
        if word is None:
            return Verdict.PASS, None, ""
        lasso = confirmed(system, word, formula)
        if lasso is None:
            return Verdict.UNKNOWN, None, "a violation was found, but its run is not confirmed"
        return Verdict.FAIL, lasso, ""
