"""Some hundred different plans over the shipped skills, the same ones on every machine."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from vaso.bench.plans import flight, ground, search

__all__ = ["BenchPlan", "corpus"]

Style = Callable[[random.Random], str]

STYLES: dict[str, Sequence[Style]] = {
    "drive": ground.DRIVE,
    "bypass-object": ground.BYPASS,
    "find-object": search.FIND,
    "fly-in-square-shape-traj": flight.SQUARE,
}


@dataclass(frozen=True, slots=True)
class BenchPlan:
    """A plan of the corpus.

    Attributes:
        skill: The shipped skill that it is for.
        style: How it is written.
        source: Its text.
    """

    skill: str
    style: str
    source: str


def corpus(count: int = 400, seed: int = 0) -> list[BenchPlan]:
    """Different plans, skill after skill and style after style.

    Args:
        count: How many.
        seed: Another seed gives other distances, names and faults.
    """
    rng = random.Random(seed)
    found: dict[str, BenchPlan] = {}
    turn = 0
    while len(found) < count:
        skill = list(STYLES)[turn % len(STYLES)]
        styles = STYLES[skill]
        style = styles[turn // len(STYLES) % len(styles)]
        source = style(rng)
        found.setdefault(source, BenchPlan(skill, style.__name__, source))
        turn += 1
    return list(found.values())
