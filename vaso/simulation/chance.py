"""Independent streams of random numbers, each from the seed of a run and a name.

What one stream has drawn never changes another one: more people, or a plan that reads one more
sensor, leave the wind and all other readings as they were.
"""

from __future__ import annotations

import hashlib
import math
import random
from collections.abc import Hashable

from vaso.simulation.geometry import Point

__all__ = ["disc", "share", "stream"]


def stream(seed: int, *names: Hashable) -> random.Random:
    """A generator of its own for one source of chance."""
    return random.Random(_digest(seed, names))


def share(seed: int, *names: Hashable) -> float:
    """One number in [0, 1) that depends on nothing but the seed and the names."""
    return (_digest(seed, names) >> 11) / 2**53


def disc(numbers: random.Random, radius: float) -> Point:
    """A point drawn evenly from a disc about the origin."""
    distance, angle = radius * math.sqrt(numbers.random()), math.tau * numbers.random()
    return (distance * math.cos(angle), distance * math.sin(angle))


def _digest(seed: int, names: tuple[Hashable, ...]) -> int:
    text = f"{seed}/{'/'.join(map(str, names))}".encode()
    return int.from_bytes(hashlib.blake2b(text, digest_size=8).digest(), "big")
