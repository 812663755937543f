"""Whether a rule that holds on one plan holds on every plan, and why.

The questions go to the system of all plans (:mod:`vaso.verification.any_plan`), first with what
is known about the first state, then with less and less: the last fact without which the rule would
not hold is the reason that it does.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from enum import StrEnum

from vaso.ltl import Binary, Formula, Unary, propositions, variables
from vaso.plan.transition_system import State, TransitionSystem
from vaso.platforms import Platform
from vaso.skill import Rule
from vaso.verdict import Verdict
from vaso.verification.any_plan import Fact, any_plan
from vaso.verification.occurrences import occurrences
from vaso.verification.queries import Checker, Query
from vaso.verifiers.base import Verifier

__all__ = ["Kind", "Passed", "Regardless", "regardless"]

_TOO_MANY = "whether every plan keeps it: its comparisons are too many, or not linear"


@dataclass(frozen=True, slots=True)
class Passed:
    """A rule that holds.

    Attributes:
        formula: The rule.
        needed: The assumptions that its PASS rests on.
    """

    formula: Formula
    needed: tuple[Rule, ...] = ()

    def query(self, formula: Formula) -> Query:
        """The question whether another formula holds under the same assumptions."""
        return Query(formula, self.given)

    @property
    def given(self) -> tuple[Formula, ...]:
        """The assumptions as formulas."""
        return tuple(rule.formula for rule in self.needed)


class Kind(StrEnum):
    """What makes a rule true of every plan; UNKNOWN where that could not be found out."""

    TAUTOLOGY = "tautology"
    ASSUMED = "assumed"
    PLATFORM = "platform"
    FIRST_STATE = "first state"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Regardless:
    """A rule that holds whatever the plan does.

    Attributes:
        kind: What makes it hold.
        text: That in words.
    """

    kind: Kind
    text: str


def regardless(
    passed: Passed, robot: Platform, system: TransitionSystem, verifier: Verifier, deadline: float
) -> Regardless | None:
    """Find out whether a rule that holds on a plan holds whatever the plan does.

    Args:
        passed: The rule.
        robot: The platform.
        system: The plan's system; only its first state is looked at.
        verifier: Decides formulas.
        deadline: When to give up, in the time of :func:`time.monotonic`.

    Returns:
        Why it holds on every plan, or that this is not known; None if it does not.
    """
    return _Question(passed, robot, system, verifier, deadline).answer()


class _Question:
    def __init__(
        self,
        passed: Passed,
        robot: Platform,
        system: TransitionSystem,
        verifier: Verifier,
        deadline: float,
    ) -> None:
        self.passed, self.robot, self.system = passed, robot, system
        self.verifier, self.deadline = verifier, deadline
        self.unknown = ""

    def answer(self) -> Regardless | None:
        rule, all_facts = self.passed.formula, frozenset(Fact)
        if not self._holds(rule, all_facts, at_rest=True):
            return Regardless(Kind.UNKNOWN, self.unknown) if self.unknown else None
        if not self._holds(rule, all_facts):
            return Regardless(Kind.FIRST_STATE, self._first_state())
        if self.passed.needed:
            told = " and ".join(r.text for r in self.passed.needed)
            text = f"it follows from the assumption {told}, whatever the plan does"
            return Regardless(Kind.ASSUMED, text)
        if self._holds(rule, frozenset()):
            return Regardless(Kind.TAUTOLOGY, "it is true whatever happens, so it asks for nothing")
        return Regardless(Kind.PLATFORM, self._platform())

    def _holds(self, formula: Formula, facts: frozenset[Fact], *, at_rest: bool = False) -> bool:
        """True where it is known that every plan satisfies a formula."""
        first = (self._rest(), self.system.sensors) if at_rest else None
        about = [formula, *self.passed.given]
        plans = any_plan(about, self.robot, facts=facts, first=first)
        if plans is None:
            self.unknown = _TOO_MANY
            return False
        left = max(0.0, self.deadline - time.monotonic())
        checker = Checker(plans, self.verifier, left)
        answer = checker.ask([self.passed.query(formula)])[0]
        if answer.verdict in (Verdict.UNKNOWN, Verdict.UNSUPPORTED):
            self.unknown = f"whether every plan keeps it: {answer.reason}"
        return answer.verdict is Verdict.PASS

    def _rest(self) -> State:
        """The first state; what follows it is known here, even where it was not explored."""
        return replace(self.system.states[0], cut=False)

    def _first_state(self) -> str:
        """Which promise of the rule is kept at once."""
        for goal in _goals(self.passed.formula):
            if self._holds(goal, frozenset(Fact), at_rest=True):
                return f"already true in the first state, before the plan acts: {goal}"
        return "it holds whatever the plan does after the first state"

    def _platform(self) -> str:
        """Which facts about the platform the rule follows from."""
        needed = frozenset(Fact)
        for fact in Fact:
            if self._holds(self.passed.formula, needed - {fact}):
                needed -= {fact}
        told = "; ".join(self._words(fact) for fact in Fact if fact in needed)
        return f"true of every plan for {self.robot.name}, if the labels are right: {told}"

    def _words(self, fact: Fact) -> str:
        rule = self.passed.formula
        names = sorted(variables(rule) | propositions(rule))
        specs = [s for s in map(self.robot.proposition, names) if s is not None]
        if fact is Fact.RANGE:
            ranges = [(s.name, s.minimum) for s in specs if s.minimum is not None]
            return " and ".join(f"{name} is never below {least:g}" for name, least in ranges)
        if fact is Fact.SAME_SENSOR:
            return f"{' and '.join(s.name for s in specs if s.sensor)} come from the same sensor"
        return str(fact)


def _goals(rule: Formula) -> list[Formula]:
    """What the rule wants to become true at some time."""
    goals: list[Formula] = []
    parts = [rule, *(p.formula for p in occurrences(rule) if p.positive)]
    for part in parts:
        match part:
            case Unary("F", goal) | Binary("U", _, goal):
                goals.append(goal)
    return goals
