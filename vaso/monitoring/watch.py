"""The rules of a skill, watched while a run goes on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from vaso.errors import FormulaError, VasoError
from vaso.ltl import Binary, Formula, Unary, nnf, propositions, to_english, variables
from vaso.ltl.progression import Demand
from vaso.monitoring.monitor import Monitor, Situation, Truth
from vaso.monitoring.split import Split, split
from vaso.monitoring.tolerance import EXACT, Tolerance
from vaso.plan.transition_system import Label
from vaso.platforms import Platform, get_platform
from vaso.skill import Rule, Skill

__all__ = ["RuleStatus", "Watch", "Watched"]

MAX_POSSIBLE = 256
"""Situations that may be possible at the same time where some values are not known."""


@dataclass(frozen=True, slots=True)
class RuleStatus:
    """What is known of a rule so far.

    Attributes:
        rule: The rule.
        is_safety: True if it can only be violated, never brought about.
        truth: Satisfied or violated whatever follows, or open.
        step: The step in which that was decided; None while it is open.
        awaited: What still has to come about for the rule to be kept; empty where nothing has.
        unknown: Names of propositions of the rule that had no value in some step.
        problem: Why the rule is not watched, or empty.
    """

    rule: Rule
    is_safety: bool
    truth: Truth = Truth.OPEN
    step: int | None = None
    awaited: tuple[Formula, ...] = ()
    unknown: tuple[str, ...] = ()
    problem: str = ""

    @property
    def waits(self) -> bool:
        """True where something has to come about that has not."""
        return bool(self.awaited)


@dataclass
class Watched:
    """One rule with where its monitors are.

    Attributes:
        rule: The rule.
        parts: Its safety and liveness parts.
        problem: Why it is not watched any more, or empty.
    """

    rule: Rule
    parts: Split
    problem: str = ""
    truth: Truth = Truth.OPEN
    step: int | None = None
    _monitors: tuple[Monitor, ...] = ()
    _possible: list[frozenset[Situation]] = field(default_factory=list)
    _unknown: set[str] = field(default_factory=set)
    _tolerance: Tolerance = EXACT

    @classmethod
    def of(cls, rule: Rule, tolerance: Tolerance = EXACT) -> Watched:
        """Start to watch a rule."""
        parts = split(nnf(rule.formula))
        watched = cls(rule, parts, _tolerance=tolerance)
        formulas = [parts.safety] if parts.liveness is None else [parts.safety, parts.liveness]
        try:
            watched._monitors = tuple(map(Monitor, formulas))
        except FormulaError as error:
            watched.problem = error.message
        watched._possible = [frozenset({m.start}) for m in watched._monitors]
        return watched

    def observe(self, step: int, labels: Mapping[str, Label]) -> None:
        """Take a step."""
        if self.problem or self.truth is not Truth.OPEN:
            return
        try:
            for index, monitor in enumerate(self._monitors):
                letter = self._tolerance.letter(monitor.atoms, labels)
                if None in letter:
                    self._note_unknown(labels)
                self._possible[index] = monitor.all_after(self._possible[index], letter)
                if len(self._possible[index]) > MAX_POSSIBLE:
                    raise FormulaError("too many of its propositions have no value")
        except FormulaError as error:
            self.problem = error.message
            return
        self._decide(step)

    @property
    def status(self) -> RuleStatus:
        """What is known so far."""
        awaited: tuple[Formula, ...] = ()
        if self.truth is Truth.OPEN and self.parts.liveness is not None and not self.problem:
            awaited = _awaited([s.demanded for s in self._possible[-1]])
        return RuleStatus(
            rule=self.rule,
            is_safety=self.parts.liveness is None,
            truth=self.truth,
            step=self.step,
            awaited=awaited,
            unknown=tuple(sorted(self._unknown)),
            problem=self.problem,
        )

    def _decide(self, step: int) -> None:
        said = [
            {monitor.truth(s) for s in possible}
            for monitor, possible in zip(self._monitors, self._possible, strict=True)
        ]
        if {Truth.VIOLATED} in said:
            self.truth, self.step = Truth.VIOLATED, step
        elif said[-1] == {Truth.SATISFIED}:
            self.truth, self.step = Truth.SATISFIED, step

    def _note_unknown(self, labels: Mapping[str, Label]) -> None:
        names = propositions(self.rule.formula) | variables(self.rule.formula)
        self._unknown |= {n for n in names if n not in labels}


class Watch:
    """Watches rules step by step.

    Args:
        rules: The rules.
        tolerance: How measured numbers are compared; by default every number is exact.

    Attributes:
        steps: Number of steps so far.
    """

    def __init__(self, rules: Iterable[Rule], tolerance: Tolerance = EXACT) -> None:
        self._watched = [Watched.of(rule, tolerance) for rule in rules]
        self.steps = 0

    @classmethod
    def of(cls, skill: Skill, platform: Platform | None = None) -> Watch:
        """Watch everything in a contract: global and local rules, and assumptions.

        Args:
            skill: The skill.
            platform: Says how exact measured numbers are; by default the skill's.
        """
        robot = platform or _platform(skill)
        rules = (*skill.rules, *skill.assumptions)
        return cls(rules, Tolerance.of(robot) if robot else EXACT)

    def observe(self, labels: Mapping[str, Label]) -> None:
        """Take a step.

        Args:
            labels: The value of every proposition in it, as far as it is known.
        """
        for watched in self._watched:
            watched.observe(self.steps, labels)
        self.steps += 1

    @property
    def statuses(self) -> tuple[RuleStatus, ...]:
        """What is known of each rule."""
        return tuple(w.status for w in self._watched)

    def describe(self, platform: Platform) -> list[str]:
        """One line a rule, for people."""
        return [_line(status, platform) for status in self.statuses]


def _platform(skill: Skill) -> Platform | None:
    try:
        return get_platform(skill.platform)
    except VasoError:
        return None


def _line(status: RuleStatus, platform: Platform) -> str:
    english = to_english(status.rule.formula, platform.phrases)
    if status.problem:
        return f"? {english} (not watched: {status.problem})"
    if status.truth is Truth.VIOLATED:
        return f"✗ {english} (violated in step {status.step})"
    if status.truth is Truth.SATISFIED:
        return f"✓ {english}"
    if status.waits:
        return f"… {english} (not yet: {' and '.join(map(str, status.awaited))})"
    return f"· {english} (kept so far)"


def _awaited(demands: Iterable[Demand]) -> tuple[Formula, ...]:
    """What has to come about, in the alternative that asks for least; nothing if that is none."""
    least: tuple[Formula, ...] | None = None
    for demanded in demands:
        for term in demanded:
            wanted = {_wanted(f) for f in term} - {None}
            found = tuple(sorted((f for f in wanted if f is not None), key=str))
            if least is None or len(found) < len(least):
                least = found
    return least or ()


def _wanted(formula: Formula) -> Formula | None:
    match formula:
        case Unary("F", operand):
            return operand
        case Binary("U", _, right):
            return right
    return None
