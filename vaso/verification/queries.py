"""Questions about one transition system, answered with three truth values."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

from vaso.ltl import Formula, conjunction, implies
from vaso.plan.transition_system import TransitionSystem
from vaso.verdict import Verdict
from vaso.verification.cuts import explain, mark, strengthen, weaken
from vaso.verifiers.base import Answer, Verifier

__all__ = ["Checker", "Query"]


@dataclass(frozen=True, slots=True)
class Query:
    """Does every run that satisfies the assumptions satisfy the formula?

    Attributes:
        formula: The formula.
        given: Assumptions about the environment.
    """

    formula: Formula
    given: tuple[Formula, ...] = ()

    def under_assumptions(self, formula: Formula) -> Formula:
        """``assumptions -> formula``."""
        return implies(conjunction(self.given), formula) if self.given else formula


class Checker:
    """Puts queries to a verifier, many at a time, within one time limit.

    Args:
        system: The system.
        verifier: Decides formulas on it.
        timeout: Seconds for everything that is asked of this object.
    """

    def __init__(self, system: TransitionSystem, verifier: Verifier, timeout: float) -> None:
        self.is_cut = any(state.cut for state in system.states)
        self.system = mark(system) if self.is_cut else system
        self.verifier = verifier
        self.deadline = time.monotonic() + timeout

    def ask(self, queries: Sequence[Query], *, counterexamples: bool = False) -> list[Answer]:
        """Answer queries. On a cut system, PASS and FAIL hold whatever follows the cuts."""
        if not self.is_cut:
            return self._check([q.under_assumptions(q.formula) for q in queries], counterexamples)
        # Assumptions are about sensors, which are free and have their meaning in cut states too,
        # so a violation must keep them to the letter; a proof may not rely on that.
        weak = [q.under_assumptions(weaken(q.formula)) for q in queries]
        strong = [strengthen(q.under_assumptions(q.formula)) for q in queries]
        answers = self._check([*weak, *strong], counterexamples)
        pairs = zip(answers[: len(weak)], answers[len(weak) :], strict=True)
        return [self._both(violated, proved) for violated, proved in pairs]

    def _check(self, formulas: Sequence[Formula], counterexamples: bool) -> list[Answer]:
        if not formulas:
            return []
        left = max(0.0, self.deadline - time.monotonic())
        return self.verifier.check(
            self.system, formulas, timeout=left, counterexamples=counterexamples
        )

    def _both(self, violated: Answer, proved: Answer) -> Answer:
        seconds = violated.seconds + proved.seconds
        if violated.verdict is Verdict.FAIL:
            return replace(violated, seconds=seconds)
        if proved.verdict is Verdict.PASS:
            return replace(proved, seconds=seconds)
        for answer in (violated, proved):
            if answer.verdict in (Verdict.UNSUPPORTED, Verdict.UNKNOWN):
                return replace(answer, seconds=seconds)
        cut = self.system.cut
        verdict = Verdict.UNKNOWN if cut is None or cut.supported else Verdict.UNSUPPORTED
        return Answer(verdict, proved.engine, seconds, reason=explain(cut))
