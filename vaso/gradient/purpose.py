"""Whether an edited plan still does what the plan was for: a cheap guard, not a proof.

A plan that only stops is safe and useless. Two things must survive an edit: every action that the
plan can execute, and, for a trajectory, the way that it travels over the ground. Callers who know
more about the task pass a test of their own to the search.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass

from vaso.ltl import Proposition, Unary, parse
from vaso.plan.transition_system import TransitionSystem
from vaso.verdict import VerificationResult

__all__ = ["Purpose", "forbidden_actions"]

NEGLIGIBLE = 1e-6

Leg = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Purpose:
    """What a plan does, as far as its transition system shows.

    Attributes:
        calls: Names of the functions through which the plan commands the robot.
        legs: For a trajectory: its horizontal displacements, straight parts joined.
    """

    calls: frozenset[str] = frozenset()
    legs: tuple[Leg, ...] | None = None

    @classmethod
    def of(cls, result: VerificationResult) -> Purpose | None:
        """The purpose of a verified plan; None where there is no transition system."""
        system = result.system
        if not isinstance(system, TransitionSystem):
            return None
        calls = frozenset(s.api.partition("(")[0] for s in system.states if s.api)
        return cls(calls, _legs(system))

    def kept_by(self, other: Purpose, dispensable: frozenset[str] = frozenset()) -> bool:
        """Tell whether another plan still does all this, except for some dispensable calls."""
        if self.calls - dispensable - other.calls:
            return False
        if self.legs is None:
            return True
        return (
            other.legs is not None
            and len(self.legs) == len(other.legs)
            and all(
                abs(a - b) < NEGLIGIBLE
                for one, two in zip(self.legs, other.legs, strict=True)
                for a, b in zip(one, two, strict=True)
            )
        )


def forbidden_actions(formulas: list[str]) -> frozenset[str]:
    """Actions that a formula ``G !action`` forbids at any time."""
    found = set()
    for text in formulas:
        match parse(text):
            case Unary("G", Unary("!", Proposition(name))):
                found.add(name)
    return frozenset(found)


def _legs(system: TransitionSystem) -> tuple[Leg, ...] | None:
    """Joined displacements of a deterministic run of velocity vectors up to its loop."""
    if not system.is_deterministic:
        return None
    velocities = list(_velocities(system))
    if None in velocities:
        return None
    legs: list[Leg] = []
    for v in velocities:
        assert v is not None
        move = (v[0] * system.dt, v[1] * system.dt)
        if (
            legs
            and abs(legs[-1][0] * move[1] - legs[-1][1] * move[0]) < NEGLIGIBLE
            and _same_way(legs[-1], move)
        ):
            legs[-1] = (legs[-1][0] + move[0], legs[-1][1] + move[1])
        elif move != (0.0, 0.0):
            legs.append(move)
    return tuple(legs)


def _same_way(one: Leg, other: Leg) -> bool:
    return one[0] * other[0] + one[1] * other[1] >= 0


def _velocities(system: TransitionSystem) -> Iterator[tuple[float, ...] | None]:
    seen: set[int] = set()
    state = 0
    while state not in seen:
        seen.add(state)
        yield _vector(system.states[state].command)
        state = system.edges[state][0].target


def _vector(command: str) -> tuple[float, ...] | None:
    """The only argument of a command, if it is a vector of three numbers."""
    _, _, argument = command.removesuffix(")").partition("=")
    try:
        value = ast.literal_eval(argument)
    except (SyntaxError, ValueError):
        return None
    return value if isinstance(value, tuple) and len(value) == 3 else None
