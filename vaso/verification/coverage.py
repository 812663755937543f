"""What a verification has seen of a plan: lines, conditions, sensors and actions.

A line that no behaviour reaches is a mistake, or shows that the rules were checked on less than the
author had in mind. Nothing is said to be *never* so unless every behaviour was explored.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from vaso.ltl import Formula
from vaso.plan.model import Plan
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Platform
from vaso.skill import Skill
from vaso.verification.instrument import instrument
from vaso.verification.statements import ran
from vaso.verification.tracing import Trace, functions_of, trace
from vaso.verification.usage import idle_actions, unheeded, unread

__all__ = ["Branch", "Coverage", "measure"]

_NOT_WATCHED = "they make no call, and were not watched"
_ENDS_EARLY = "an exception ends the plan before its first call"
_NOT_EXPLORED = "the plan could not be explored"
_WORDS = {
    ("if", True): "the condition is always true",
    ("while", True): "the condition of the loop is always true",
    ("either", True): "`… if … else …` always takes the first value",
    ("either", False): "`… if … else …` always takes the second value",
}


@dataclass(frozen=True, slots=True)
class Branch:
    """A condition that always comes out the same way.

    Attributes:
        line: Its line.
        text: What that means: "its condition is always true".
    """

    line: int
    text: str


@dataclass(frozen=True, slots=True)
class Coverage:
    """What the behaviours of a plan use of it.

    Attributes:
        executed: Lines that run in some behaviour. Lines without code are in none of the groups.
        never: Lines that run in none (in those explored, where ``steps`` is set).
        unknown: Lines of which it is not known whether they run; ``reason`` says why.
        branches: Conditions that always come out the same way.
        unread: Observations that rules speak of and the plan never reads.
        unheeded: Observations that the plan reads, and whose value never changes what it does.
        idle_actions: Actions that rules speak of and the plan never takes.
        steps: Where not every behaviour was explored: up to which step.
        reason: Why some lines are unknown.
    """

    executed: tuple[int, ...] = ()
    never: tuple[int, ...] = ()
    unknown: tuple[int, ...] = ()
    branches: tuple[Branch, ...] = ()
    unread: tuple[str, ...] = ()
    unheeded: tuple[str, ...] = ()
    idle_actions: tuple[str, ...] = ()
    steps: int | None = None
    reason: str = ""

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return asdict(self)


def measure(
    plan: Plan,
    skill: Skill,
    robot: Platform,
    system: TransitionSystem,
    formulas: Sequence[Formula],
    *,
    seconds: float = 0.0,
) -> Coverage:
    """Find out what the behaviours of a plan use of it.

    Args:
        plan: The plan.
        skill: Its skill.
        robot: Its platform.
        system: Its automaton.
        formulas: The rules.
        seconds: Longest time for watching its lines, which takes a second exploration. Without
            it, lines that make no call are mostly unknown.
    """
    try:
        tree = ast.parse(plan.source)
    except (SyntaxError, ValueError, RecursionError):
        return Coverage(reason="the plan is not text that can be read")
    seen_all = system.cut is None and not system.warnings
    known = ran(tree, set(_called_from(system)), to_the_end=seen_all)
    functions = functions_of(skill, robot)
    found = Trace(instrument(plan.source, functions, known), reason=_NOT_WATCHED)
    if seconds > 0:
        watched = trace(plan, skill, robot, system, known, formulas, seconds)
        found = replace(watched, copy=found.copy) if watched.reason else watched
    started = bool(known or found.reached) or not system.warnings
    depths = (found.steps, system.cut.depth if system.cut else None)
    steps = [depth for depth in depths if depth is not None]
    if 0 in steps:
        found = replace(found, reason=_NOT_EXPLORED)
    executed, never, unknown = _lines(found, started)
    return Coverage(
        executed=executed,
        never=never,
        unknown=unknown,
        branches=() if found.reason else tuple(_branches(found)),
        unread=unread(system, formulas),
        unheeded=unheeded(system, formulas),
        idle_actions=idle_actions(system, formulas, skill, robot),
        steps=min(steps, default=None),
        reason=(found.reason or _ENDS_EARLY) if unknown else "",
    )


def _called_from(system: TransitionSystem) -> Iterator[int]:
    """Lines of the plan from which a call was made."""
    lines = [edge.line for out in system.edges for edge in out]
    lines += [state.line for state in system.states]
    lines += [line for out in system.edges for edge in out for _, line in edge.reads]
    return (line for line in lines if line is not None)


def _lines(found: Trace, started: bool) -> tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]:
    """Lines that run, lines that never do, and lines of which this is not known."""
    groups: dict[bool | None, set[int]] = {True: set(), False: set(), None: set()}
    for span in found.copy.spans:
        if span.point is None:
            runs = True if started else None
        else:
            runs = None if found.reason else span.point in found.reached
        groups[runs].update(range(span.first, span.last + 1))
    unknown = groups[None] - groups[True]
    never = groups[False] - groups[True] - unknown
    return tuple(sorted(groups[True])), tuple(sorted(never)), tuple(sorted(unknown))


def _branches(found: Trace) -> Iterator[Branch]:
    for choice in found.copy.choices:
        yes, no = choice.yes in found.reached, choice.no in found.reached
        if yes != no and (choice.kind, yes) in _WORDS:  # a body that is not entered is seen anyway
            yield Branch(choice.line, _WORDS[choice.kind, yes])
