"""What makes two plans of one style look different: names, remarks, distances."""

from __future__ import annotations

import random
from textwrap import indent

__all__ = ["CLEAR", "body", "metres", "periods", "remark", "turn_periods"]

FORWARD_MPS, TURN_RADPS, DT = 0.3, 0.5, 0.1

_REMARKS = (
    "# Move step by step and check the sensors before every command.\n",
    '"""Plan for the Clearpath Jackal."""\n',
    "# Safety first: stop for people, never drive into obstacles.\n",
    "# Each API call lasts one control period (0.1 s).\n",
    "",
    "",
)
CLEAR = "not people_observed() and not obstacle_observed()"


def remark(rng: random.Random) -> str:
    """A remark at the top, or none."""
    return rng.choice(_REMARKS)


def metres(rng: random.Random) -> float:
    """A distance as people ask for it."""
    return rng.choice((0.5, 1.0, 1.0, 1.5, 2.0, 2.0, 2.5, 3.0)) + rng.choice((0, 0, 0.2))


def periods(distance_m: float) -> int:
    """Control periods of ``forward()`` for a distance."""
    return round(distance_m / (FORWARD_MPS * DT))


def turn_periods(rng: random.Random) -> int:
    """Control periods of a turn by 45, 60 or 90 degrees."""
    return rng.choice((16, 21, 31))


def body(text: str) -> str:
    """A block, indented by one level."""
    return indent(text, "    ")
