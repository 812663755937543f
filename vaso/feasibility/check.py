"""Feasibility of a skill: can its rules be kept at all, before any plan is written?"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from vaso.feasibility.conflict import Conflict, find_conflict
from vaso.feasibility.result import Exercise, FeasibilityResult
from vaso.feasibility.roles import Role, check_assumption, role_finder
from vaso.feasibility.satisfiability import SatResult
from vaso.feasibility.search import Outcome, Search
from vaso.feasibility.triggers import Trigger, triggers
from vaso.platforms import Platform, get_platform
from vaso.skill import Rule, Skill
from vaso.verifiers.engine import SMVEngine

__all__ = ["check"]

SYNTHESIS_SECONDS = 5.0
"""Longest time for level (c)."""

_Triggers = Sequence[tuple[Rule, Trigger]]


def check(
    skill: Skill,
    *,
    platform: str | Path | Platform | None = None,
    timeout: float = 10.0,
    engine: SMVEngine | None = None,
    realizable: bool | None = None,
) -> FeasibilityResult:
    """Check that the contract of a skill can be kept.

    What is checked are all rules together: global, local, and the assumptions, which restrict the
    behaviours that count. Level (a) asks for some behaviour that keeps them, every proposition
    being free (the paper's check). Level (b) asks, under the platform's action exclusions, for such
    a behaviour for each trigger of a rule, in which that trigger occurs. Level (c) asks for a plan
    that keeps all rules whatever the sensors show; it needs the extra ``synthesis``.

    Args:
        skill: The skill.
        platform: Its platform, if not the one that the skill names.
        timeout: Seconds for the whole check. What is not decided by then counts as not feasible.
        engine: A model checker that decides instead of VASO's own procedure.
        realizable: Whether to check level (c); by default where the extra is installed and the
            other levels hold.

    Returns:
        The result, truthy only if no level fails and the first two hold.

    Raises:
        MissingDependencyError: Level (c) is asked for, and the extra is not installed.
        SkillError: An assumption speaks about something that the robot decides.
        FormulaError: A name is used both as a truth value and as a number.
        PlatformError: There is no such platform.
    """
    started = time.perf_counter()
    on = get_platform(platform or skill.platform)
    role = role_finder(skill, on)
    for assumption in skill.assumptions:
        check_assumption(assumption, role)
    found = [
        (rule, trigger)
        for rule in skill.rules
        for trigger in triggers(rule.formula, lambda name: role(name) is Role.WORLD)
    ]
    rules = skill.rules + skill.assumptions
    free = Search(timeout=timeout, engine=engine)
    among = Search(exclusions=on.exclusions, timeout=timeout, engine=engine)
    result = _Levels(free, among, rules, found).result(skill, started)
    left = timeout - (time.perf_counter() - started)
    return _with_plans(result, skill, on, realizable, min(left, SYNTHESIS_SECONDS), started)


def _with_plans(
    result: FeasibilityResult,
    skill: Skill,
    platform: Platform,
    wanted: bool | None,
    seconds: float,
    started: float,
) -> FeasibilityResult:
    """The result with level (c), if it is wanted and can be had."""
    from vaso.synthesis import is_installed, realizability

    if wanted is None and result.feasible is False:
        return replace(result, unchecked="not asked: no behaviour keeps the rules")
    if wanted is False:
        return replace(result, unchecked="not checked")
    if wanted is None and not is_installed():
        return replace(result, unchecked="not checked: make everything installs what it needs")
    if wanted is None and seconds <= 0:
        return replace(result, unchecked="not checked: out of time")
    found = realizability(skill, platform=platform, timeout=max(seconds, 0.1))
    return replace(
        result,
        realizability=found,
        feedback=result.feedback or found.feedback,
        seconds=time.perf_counter() - started,
    )


class _Levels:
    """The rules on their own, and under action exclusions alone and with each trigger.

    Args:
        free: Decides without exclusions.
        among: Decides with them.
        rules: All rules and assumptions.
        found: The triggers, each with the rule that it comes from.
    """

    def __init__(
        self, free: Search, among: Search, rules: Sequence[Rule], found: _Triggers
    ) -> None:
        self._free = free
        self._search = among
        self._rules = rules
        self._formulas = [r.formula for r in rules]
        self._found = _distinct(found)

    def result(self, skill: Skill, started: float) -> FeasibilityResult:
        """The answer of both levels together."""
        plain = self._satisfiable()
        base = self._search.decide(self._formulas)
        joint = self._jointly(base)
        exercised = [] if base.sat is False else self._exercise(joint)
        sat = _worst([base.sat, *(e.sat for e in exercised)])
        conflict = self._conflict(plain, base, exercised)
        reasons = [plain.reason, base.reason if base.sat is None else ""]
        reasons += [e.reason for e in exercised if e.sat is None]
        return FeasibilityResult(
            skill=skill.name,
            satisfiable=plain,
            exercisable=sat,
            triggers=tuple(exercised),
            witness=joint.witness,
            conflict=conflict,
            feedback=conflict.feedback(local_rules=len(skill.local_rules)) if conflict else "",
            assumptions=tuple(str(a) for a in skill.assumptions),
            reason="; ".join(dict.fromkeys(r for r in reasons if r)),
            seconds=time.perf_counter() - started,
        )

    def _satisfiable(self) -> SatResult:
        started = time.perf_counter()
        outcome = self._free.decide(self._formulas)
        core = find_conflict(self._free, self._rules).core if outcome.sat is False else None
        seconds = time.perf_counter() - started
        return SatResult(outcome.sat, seconds, outcome.witness, core, outcome.reason)

    def _jointly(self, base: Outcome) -> Outcome:
        """All triggers in one behaviour: where there is one, it answers for each of them."""
        if base.sat is not True:
            return Outcome(None)
        return self._search.decide([*self._formulas, *(t.occurs for _, t in self._found)])

    def _exercise(self, joint: Outcome) -> list[Exercise]:
        return [
            Exercise(str(rule), str(trigger.situation), outcome.sat, outcome.reason)
            for rule, trigger in self._found
            for outcome in [joint if joint.sat else self._with(trigger)]
        ]

    def _with(self, trigger: Trigger) -> Outcome:
        return self._search.decide([*self._formulas, trigger.occurs])

    def _conflict(
        self, plain: SatResult, base: Outcome, exercised: Sequence[Exercise]
    ) -> Conflict | None:
        """The smallest conflict: of the rules themselves, else over the triggers that fail."""
        if plain.sat is False:
            return find_conflict(self._free, self._rules)
        if base.sat is False:
            return find_conflict(self._search, self._rules, free=self._free)
        failing = [pair for pair, e in zip(self._found, exercised, strict=False) if e.sat is False]
        conflicts = [
            find_conflict(self._search, self._rules, trigger=t, owner=rule, free=self._free)
            for rule, t in failing
        ]
        return min(conflicts, key=lambda c: (not c.minimal, len(c.rules)), default=None)


def _distinct(found: _Triggers) -> _Triggers:
    unique: dict[object, tuple[Rule, Trigger]] = {}
    for rule, trigger in found:
        unique.setdefault(trigger.occurs, (rule, trigger))
    return list(unique.values())


def _worst(answers: Sequence[bool | None]) -> bool | None:
    return False if False in answers else None if None in answers else True
