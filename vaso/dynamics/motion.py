"""One channel in one control period: from what is known at its beginning to what is known inside.

Along the way from the velocity v0 to the set-point u the error keeps its direction, so
``v(t) = u - (u - v0) * left(t)`` with one factor ``left`` for all components. Its least and its
greatest value over a class of vehicles come from the quickest and from the slowest member.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from vaso.dynamics.decay import Decay
from vaso.dynamics.interval import Interval, hull
from vaso.platforms.response import Range

__all__ = ["Constants", "Motion"]


@dataclass(frozen=True, slots=True)
class Constants:
    """What is known of the constants of a channel: least and greatest lag, and acceleration."""

    lags: Range
    accelerations: Range


@dataclass(frozen=True)
class Motion:
    """A channel that starts with some velocity and follows a set-point.

    Attributes:
        setpoint: The set-point, component by component.
        start: What is known of the velocity at the beginning.
        norm: A bound on the magnitude of that velocity.
        constants: What is known of the vehicle.
    """

    setpoint: tuple[float, ...]
    start: tuple[Interval, ...]
    norm: float
    constants: Constants

    @cached_property
    def errors(self) -> tuple[Interval, ...]:
        """What is known of ``u - v0``."""
        pairs = zip(self.setpoint, self.start, strict=True)
        return tuple((u - high, u - low) for u, (low, high) in pairs)

    @cached_property
    def slow(self) -> Decay:
        """The slowest decay of the error that is possible."""
        sizes = [max(abs(low), abs(high)) for low, high in self.errors]
        return Decay(self.constants.lags[1], self.constants.accelerations[0], math.hypot(*sizes))

    @cached_property
    def quick(self) -> Decay:
        """The quickest decay of the error that is possible."""
        sizes = [max(0.0, low, -high) for low, high in self.errors]
        return Decay(self.constants.lags[0], self.constants.accelerations[1], math.hypot(*sizes))

    @property
    def is_lag(self) -> bool:
        """True when no acceleration is limited, so that the response is linear."""
        return math.isinf(self.constants.accelerations[0])

    def from_rest(self) -> Motion:
        """The same, where the velocity may also have been 0 at some time on the way."""
        return Motion(self.setpoint, _with_zero(self.start), self.norm, self.constants)

    def velocity(self, component: int, begin: float, end: float) -> Interval:
        """A component of the velocity, from one time to another."""
        least, most = self.quick.left(end), self.slow.left(begin)
        low, high = self.errors[component]
        u = self.setpoint[component]
        return (
            u - high * (most if high > 0.0 else least),
            u - low * (most if low < 0.0 else least),
        )

    def velocities(self, begin: float, end: float) -> tuple[Interval, ...]:
        """Every component of the velocity, from one time to another."""
        return tuple(self.velocity(i, begin, end) for i in range(len(self.setpoint)))

    def magnitude(self, begin: float, end: float) -> float:
        """A bound on the magnitude: the velocity is on the line from v0 to u."""
        target = math.hypot(*self.setpoint)
        grows = self.norm < target
        share = self.quick.left(end) if grows else self.slow.left(begin)
        boxed = math.hypot(*(max(abs(a), abs(b)) for a, b in self.velocities(begin, end)))
        return min(boxed, target + share * (self.norm - target))

    def path(self, component: int, factor: float, *, upper: bool) -> Path:
        """The highest, or the lowest, way that ``factor`` times a component can go."""
        highest = upper == (factor > 0.0)
        error = self.errors[component][0 if highest else 1]
        delays = (error < 0.0) == highest  # whether a slow decay leads farther that way
        return Path(
            factor * self.setpoint[component], factor * error, self.slow if delays else self.quick
        )


@dataclass(frozen=True, slots=True)
class Path:
    """A displacement over time: ``rate * t - error * area(t)``.

    Attributes:
        rate: What the velocity tends to.
        error: ``rate`` less the velocity at the beginning.
        decay: How that error decays.
    """

    rate: float
    error: float
    decay: Decay

    @property
    def speed(self) -> float:
        """The velocity at the beginning."""
        return self.rate - self.error

    def at(self, time: float) -> float:
        """The displacement at a time, which may be infinite."""
        if math.isinf(time):
            steady = self.rate * time if self.rate else 0.0
            return steady - (self.error * self.decay.area(time) if self.error else 0.0)
        return self.rate * time - self.error * self.decay.area(time)

    def over(self, begin: float, end: float) -> Interval:
        """The least and the greatest displacement from one time to another."""
        times = [begin, end]
        if self.error and 0.0 < self.rate / self.error < 1.0:  # where the velocity changes sign
            turn = self.decay.time_of(self.rate / self.error)
            times += [turn] if begin < turn < end else []
        reached = [self.at(t) for t in times]
        return min(reached), max(reached)


def _with_zero(velocities: Sequence[Interval]) -> tuple[Interval, ...]:
    return tuple(hull([v, (0.0, 0.0)]) for v in velocities)
