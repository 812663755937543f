"""Who takes a step when: all together, one at a time, or any of them.

Where the order is open, it is decided by a *turn* that is free in every step, like a sensor. So
the product stays a deterministic system over free inputs, and every engine can check it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, get_args

from vaso.errors import SkillError
from vaso.plan.transition_system import Scalar, Sensor

__all__ = ["MODES", "TURN", "Mode", "Schedule", "make_schedule"]

Mode = Literal["synchronous", "interleaving", "asynchronous"]
MODES: tuple[Mode, ...] = get_args(Mode)
TURN = "turn"
"""The free choice of who moves."""
MOST_PHASES = 1_000
"""Greatest number of steps after which control periods meet again."""
MOST_MEMBERS = 6
"""Greatest number of members of which any subset may move."""


@dataclass(frozen=True)
class Schedule:
    """Who moves from each phase under each turn.

    Attributes:
        dt: Seconds of one step; None where steps have no fixed length.
        phases: Number of phases; one step leads from each to the next.
        turn: The free choice, if there is one.
        movers: For each phase, the members that move under each value of the turn.
        clocks: The members that do not move in every step.
    """

    dt: float | None
    phases: int
    turn: Sensor | None
    movers: tuple[tuple[tuple[Scalar | None, frozenset[int]], ...], ...]
    clocks: frozenset[int]


def make_schedule(
    mode: str, names: Sequence[str], periods: Sequence[float], *, step: float | None = None
) -> Schedule:
    """The schedule of a composition.

    Args:
        mode: ``synchronous``, ``interleaving`` or ``asynchronous``.
        names: The members.
        periods: Their control periods in seconds.
        step: For the synchronous mode, the length of a step, of which every period is a multiple;
            by default the longest that there is.

    Raises:
        SkillError: There is no such mode, or the periods do not fit together.
    """
    if mode not in MODES:
        raise SkillError(f"there is no mode '{mode}'", expected=f"one of {', '.join(MODES)}")
    if mode == "synchronous" or len(names) == 1:
        return _together(names, periods, step)
    options: list[tuple[Scalar | None, frozenset[int]]] = [
        (name, frozenset([i])) for i, name in enumerate(names)
    ]
    if mode == "asynchronous":
        options += _several(names)
    turn = Sensor(TURN, tuple(str(value) for value, _ in options))
    return Schedule(None, 1, turn, (tuple(options),), frozenset(range(len(names))))


def _several(names: Sequence[str]) -> list[tuple[Scalar | None, frozenset[int]]]:
    if len(names) > MOST_MEMBERS:
        raise SkillError(
            f"{len(names)} members are too many for the asynchronous mode",
            expected=f"at most {MOST_MEMBERS}",
            hint="compose fewer members at a time, or use the synchronous mode",
        )
    sizes = range(2, len(names) + 1)
    groups = [g for size in sizes for g in itertools.combinations(range(len(names)), size)]
    return [(" and ".join(names[i] for i in group), frozenset(group)) for group in groups]


def _together(names: Sequence[str], periods: Sequence[float], step: float | None) -> Schedule:
    exact = [_exact(period) for period in periods]
    base = _exact(step) if step is not None else _common(exact)
    every = [int(period / base) for period in exact]
    phases = math.lcm(*every)
    if phases > MOST_PHASES:
        told = ", ".join(f"{n}: {p:g} s" for n, p in zip(names, periods, strict=True))
        raise SkillError(
            f"the control periods do not fit together ({told})",
            expected=f"periods that meet again after at most {MOST_PHASES} common steps",
            hint="use the interleaving or the asynchronous mode",
        )
    movers = tuple(
        ((None, frozenset(i for i, k in enumerate(every) if (phase + 1) % k == 0)),)
        for phase in range(phases)
    )
    slow = frozenset(i for i, k in enumerate(every) if k > 1)
    return Schedule(float(base), phases, None, movers, slow)


def _exact(seconds: float) -> Fraction:
    return Fraction(str(seconds)).limit_denominator(10**9)


def _common(periods: Sequence[Fraction]) -> Fraction:
    """The longest step of which every period is a multiple."""
    denominator = math.lcm(*(p.denominator for p in periods))
    return Fraction(math.gcd(*(int(p * denominator) for p in periods)), denominator)
