"""Wind with gusts: a mean, and a first-order Gauss-Markov process about it.

The exponentially correlated process is the simplest gust model with a time scale (Beard & McLain,
Small Unmanned Aircraft, 2012, section 4.4, on how the Dryden spectra are generated).
"""

from __future__ import annotations

import math

from vaso.simulation.chance import stream
from vaso.simulation.scene import Wind
from vaso.simulation.truth import Vector

__all__ = ["Gusts", "settle"]

_VERTICAL = 0.5


def settle(wind: Wind, seed: int) -> Wind:
    """The wind of one seed: its mean turned and scaled within ``spread``."""
    if not wind.spread:
        return wind
    numbers = stream(seed, "mean wind")
    factor = 1.0 + numbers.uniform(-wind.spread, wind.spread)
    angle = numbers.uniform(-wind.spread, wind.spread)
    (north, east, down), cos, sin = wind.mean, math.cos(angle), math.sin(angle)
    mean = (
        factor * (north * cos - east * sin),
        factor * (north * sin + east * cos),
        factor * down,
    )
    return wind.model_copy(update={"mean": mean, "spread": 0.0})


class Gusts:
    """The wind of a run as time passes.

    Args:
        wind: Mean and gusts.
        seed: Of the run.

    Attributes:
        now: Where the air goes, north, east, down, in m/s.
    """

    def __init__(self, wind: Wind, seed: int) -> None:
        self._wind = wind
        self._numbers = stream(seed, "gusts")
        sigma = wind.gusts
        self._sigmas = (sigma, sigma, sigma * _VERTICAL)
        self._parts = [self._numbers.gauss(0.0, s) for s in self._sigmas]
        self.now = self._sum()

    def blow(self, seconds: float) -> None:
        """Let time pass: the process's exact discretisation, whatever the step."""
        if not self._wind.gusts:
            return
        kept = math.exp(-seconds / self._wind.time_scale)
        fresh = math.sqrt(1.0 - kept * kept)
        gauss = self._numbers.gauss
        self._parts = [
            kept * part + fresh * gauss(0.0, sigma)
            for part, sigma in zip(self._parts, self._sigmas, strict=True)
        ]
        self.now = self._sum()

    def _sum(self) -> Vector:
        north, east, down = self._wind.mean
        return (north + self._parts[0], east + self._parts[1], down + self._parts[2])
