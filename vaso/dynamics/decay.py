"""How the error of a set-point decays: the closed form of the response to one step.

With e the distance between velocity and set-point, ``e' = -min(e / lag, limit)``. So e falls in a
straight line while ``e > limit * lag``, and exponentially from there on (Åström & Murray, Feedback
Systems, 2008, section 5.3, for the step response of a first-order system).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

__all__ = ["Decay"]


@dataclass(frozen=True)
class Decay:
    """The share of an error that is left as time passes.

    ``left`` grows with the size of the error and with the lag, and falls with the limit, so that
    the extreme members of a class of vehicles bound all others.

    Attributes:
        lag: Time constant in seconds; 0 for none.
        limit: Greatest rate of change; infinite for none.
        size: The error at time 0, not negative.
    """

    lag: float
    limit: float
    size: float

    @cached_property
    def _straight(self) -> float:
        """How long the error falls at its greatest rate, in seconds."""
        if math.isinf(self.limit):
            return 0.0
        return max(0.0, self.size / self.limit - self.lag)

    @cached_property
    def _after(self) -> float:
        """The share that is left when the straight part ends."""
        if self.lag == 0:
            return 0.0
        return 1.0 - self.limit * self._straight / self.size if self._straight else 1.0

    @cached_property
    def _straight_area(self) -> float:
        span = self._straight
        return span - self.limit * span * span / (2.0 * self.size) if span else 0.0

    def left(self, time: float) -> float:
        """The share of the error that is left, in [0, 1]. Right after the step, for time 0."""
        if time < self._straight:
            return 1.0 - self.limit * time / self.size
        if self.lag == 0:
            return 0.0
        return self._after * math.exp((self._straight - time) / self.lag)

    def area(self, time: float) -> float:
        """The integral of ``left`` from 0 to a time, which may be infinite; in seconds."""
        if time < self._straight:
            return time - self.limit * time * time / (2.0 * self.size)
        if self.lag == 0:
            return self._straight_area
        gone = -math.expm1((self._straight - time) / self.lag)
        return self._straight_area + self._after * self.lag * gone

    def time_of(self, share: float) -> float:
        """When the share falls to a value in (0, 1); 0 where it jumps there."""
        if share >= self._after and self._straight:
            return (1.0 - share) * self.size / self.limit
        if self.lag == 0 or share >= self._after:
            return self._straight
        return self._straight + self.lag * math.log(self._after / share)
