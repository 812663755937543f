"""The path that a plan means, and the set-point that keeps a vehicle on it.

A plan says one velocity a period. Flown open loop, take-off ramps, drag, drift and noise add up to
metres. So the driver follows the *nominal path*, the integral of the velocities from the take-off
point, with

    set-point = v + limited(K * (expected - measured)),

the velocity as feed-forward and a bounded correction. ``expected`` is the nominal position through
a first-order lag, because no vehicle starts at once: without it, every leg would begin with a
correction that is not needed. Where the plan stands still, the set-point is the position itself.

All vectors are north, east, down in metres from the take-off point.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["NominalPath", "SetPoint", "Vector"]

Vector = tuple[float, float, float]
ZERO: Vector = (0.0, 0.0, 0.0)

GAIN = 0.6  # 1/s
LAG_S = 0.5  # about that of PX4's velocity controller, MPC_XY_VEL_P_ACC
REACH = 0.5  # m: a position set-point is no farther away than this, so that PX4 does not hurry
LEAST_CLIMB = 0.3  # m/s, below which a vehicle may not come off the ground
NANO = 9


@dataclass(frozen=True)
class SetPoint:
    """What is sent to the vehicle: a velocity, or a position relative to the take-off point."""

    velocity: Vector | None = None
    position: Vector | None = None


class NominalPath:
    """Where the vehicle should be.

    Args:
        correction: The most, in m/s, that is added to a velocity.
        tracking_speed: Corrections do not make the vehicle faster than this, in m/s.

    Attributes:
        position: The nominal position.
        velocity: The velocity of the period that runs.
        left: Seconds of the period that are left; 0 when it is over.
    """

    def __init__(self, correction: float, tracking_speed: float) -> None:
        self.position = ZERO
        self.velocity = ZERO
        self.left = 0.0
        self._expected = ZERO
        self._end = ZERO
        self._correction = correction
        self._tracking_speed = tracking_speed

    @property
    def altitude(self) -> float:
        """Nominal altitude."""
        return -self.position[2]

    @property
    def end_altitude(self) -> float:
        """Nominal altitude at the end of the period that runs."""
        return -self._end[2]

    @property
    def stands(self) -> bool:
        """Whether nothing moves nominally now."""
        return self.left <= 0 or math.hypot(*self.velocity) == 0

    def end_of(self, velocity: Vector, period: float) -> Vector:
        """Where a period from here would end. The ground carries whatever does not climb."""
        if self.altitude <= 0 and velocity[2] >= 0:
            return self.position
        moved = [round(p + v * period, NANO) for p, v in zip(self.position, velocity, strict=True)]
        return (moved[0], moved[1], min(0.0, moved[2]))

    def begin(self, velocity: Vector, period: float) -> None:
        """Begin a period of so many seconds with a velocity."""
        self._end = self.end_of(velocity, period)
        self.velocity = velocity if self._end != self.position else ZERO
        self.left = period

    def advance(self, seconds: float) -> None:
        """Let time pass. At the end of the period the position is exactly its end."""
        step = min(seconds, self.left)
        self.left = self.left - step if self.left - step > 1e-6 else 0.0
        if self.left == 0 or self.velocity == ZERO:
            self.position = self._end
        else:
            ahead = [e - v * self.left for e, v in zip(self._end, self.velocity, strict=True)]
            self.position = (ahead[0], ahead[1], min(0.0, ahead[2]))
        self._lag(seconds)

    def settle(self, seconds: float) -> None:
        """Let time pass without motion: the vehicle catches up."""
        self._lag(seconds)

    def _lag(self, seconds: float) -> None:
        share = 1 - math.exp(-seconds / LAG_S)
        self._expected = _along(self._expected, self.position, share)

    def touch_down(self) -> None:
        """The ground was reached: the path goes on from there."""
        self._end = (self._end[0], self._end[1], 0.0)
        self.position = (self.position[0], self.position[1], 0.0)
        self.velocity = ZERO

    def setpoint(self, measured: Vector) -> SetPoint:
        """The set-point for a vehicle that is at ``measured``."""
        if self.stands:
            return SetPoint(position=_along(measured, self.position, 1.0, REACH))
        error = _minus(self._expected, measured)
        extra = _limited(_times(error, GAIN), self._correction)
        wanted = _plus(self.velocity, extra)
        most = max(self._tracking_speed, math.hypot(*self.velocity))
        return SetPoint(velocity=_limited(wanted, most))

    def climb(self) -> SetPoint:
        """The set-point that brings a vehicle off the ground."""
        return SetPoint(velocity=(0.0, 0.0, min(self.velocity[2], -LEAST_CLIMB)))


def _plus(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _times(a: Vector, factor: float) -> Vector:
    return (a[0] * factor, a[1] * factor, a[2] * factor)


def _limited(a: Vector, most: float) -> Vector:
    length = math.hypot(*a)
    return a if length <= most else _times(a, most / length)


def _along(start: Vector, end: Vector, share: float, most: float = math.inf) -> Vector:
    """The point at a share of the way, at most so far from the start."""
    return _plus(start, _limited(_times(_minus(end, start), share), most))
