"""Which lines of a plan run in some behaviour, found by exploring an instrumented copy.

The copy must do what the plan does. That is not taken on trust: both automata are walked through
side by side, and what the copy shows counts only if they never differ.
"""

from __future__ import annotations

import ast
import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from vaso.errors import VasoError
from vaso.ltl import Formula
from vaso.plan.explore import Budget, compile_plan
from vaso.plan.model import Plan
from vaso.plan.transition_system import Guard, Scalar, TransitionSystem
from vaso.platforms import Platform, SensorSpec
from vaso.skill import Skill
from vaso.verification.instrument import POINT, Instrumented, instrument
from vaso.verification.statements import Place

__all__ = ["Trace", "functions_of", "trace"]

_DIFFERS = "the plan computes so much between two commands that its lines cannot be watched"
_TOO_LONG = "watching its lines takes too long"


@dataclass(frozen=True, slots=True)
class Trace:
    """What the instrumented copy shows.

    Attributes:
        copy: The copy.
        reached: The points that are passed in some behaviour.
        steps: Up to which step the copy was explored; None for all of them.
        reason: Why nothing is known; then ``reached`` is empty.
    """

    copy: Instrumented
    reached: frozenset[int] = frozenset()
    steps: int | None = None
    reason: str = ""


def trace(
    plan: Plan,
    skill: Skill,
    robot: Platform,
    system: TransitionSystem,
    known_to_run: Collection[Place] = (),
    formulas: Sequence[Formula] = (),
    seconds: float = 10.0,
) -> Trace:
    """Explore an instrumented copy of a plan.

    Args:
        plan: The plan.
        skill: Supplies the labelling code.
        robot: The platform.
        system: The plan's own automaton.
        known_to_run: Statements that need not be watched.
        formulas: The formulas for which the automaton was made.
        seconds: Longest time for the exploration.
    """
    sensor = SensorSpec(name=POINT, parameters=("point",), domain=(False,))
    watched = robot.model_copy(update={"sensors": (*robot.sensors, sensor)})
    deadline = time.monotonic() + seconds
    found = Trace(Instrumented(), reason=_TOO_LONG)
    for once in (False, True) if robot.sensors else (True,):
        copy = instrument(plan.source, functions_of(skill, robot), known_to_run, once=once)
        left = max(0.0, deadline - time.monotonic())
        budget = Budget(states=2 * len(system.states) + 100, seconds=left)
        try:
            other = compile_plan(
                copy.text, skill, platform=watched, formulas=formulas, budget=budget
            )
        except VasoError:
            found = Trace(copy, reason=_DIFFERS)
            continue
        found = _compared(system, other, copy)
        if not found.reason:
            break
    return found


def _compared(system: TransitionSystem, other: TransitionSystem, copy: Instrumented) -> Trace:
    """What an automaton of the copy shows about the plan."""
    if other.cut is not None and system.cut is None:
        return Trace(copy, reason=_TOO_LONG)
    if not _behave_alike(system, other):
        return Trace(copy, reason=_DIFFERS)
    return Trace(copy, _reached(other), other.cut.depth if other.cut else None)


def functions_of(skill: Skill, robot: Platform) -> set[str]:
    """Functions that plans may call without defining them."""
    code = ast.parse(skill.labelling_code).body
    functions = {n.name for n in code if isinstance(n, ast.FunctionDef)}
    return functions | {c.name for c in robot.commands} | {s.name for s in robot.sensors}


def _behave_alike(one: TransitionSystem, other: TransitionSystem) -> bool:
    """True when two automata do the same under the same readings, as far as both were explored."""
    pairs = [(0, 0)]
    seen = set(pairs)
    for a, b in pairs:
        here, there = one.states[a], other.states[b]
        if (here.command, here.labels, here.observed) != (
            there.command,
            there.labels,
            there.observed,
        ):
            return False
        if here.cut or there.cut:
            continue
        after, afterwards = _targets(one, a), _targets(other, b)
        if after.keys() != afterwards.keys():
            return False
        new = {(after[guard], afterwards[guard]) for guard in after} - seen
        seen |= new
        pairs += new
    return True


def _targets(system: TransitionSystem, state: int) -> Mapping[frozenset[tuple[str, Scalar]], int]:
    """Where each reading of the sensors leads, without the points."""
    return {_readings(edge.guard): edge.target for edge in system.edges[state]}


def _readings(guard: Guard) -> frozenset[tuple[str, Scalar]]:
    return frozenset((n, v) for n, v in guard.items() if not n.startswith(POINT))


def _reached(system: TransitionSystem) -> frozenset[int]:
    names = (name for out in system.edges for edge in out for name, _ in edge.reads)
    return frozenset(
        int(name.removeprefix(f"{POINT}(").removesuffix(")"))
        for name in names
        if name.startswith(POINT)
    )
