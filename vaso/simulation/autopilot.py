"""Between a plan's set-points and the vehicle: the adapter's position loop, and PX4's take-off.

The adapter of a real vehicle does not send a plan's velocities as they are: take-off ramps, drag
and wind would carry the vehicle metres away from where the set-points lead. It integrates them to
a reference position and adds a bounded correction towards it.
"""

from __future__ import annotations

import math

from vaso.simulation.truth import Vector

__all__ = ["ZERO", "TakeOff", "Tracker"]

ZERO: Vector = (0.0, 0.0, 0.0)
GRAVITY = 9.80665


class Tracker:
    """The nominal position of a plan's set-points, and the velocity that leads there.

    Args:
        start: Position at the beginning: north, east, altitude in metres.
        gains: Correction in m/s for each metre, horizontally and vertically; PX4's own position
            loop has 0.95 and 1 (``MPC_XY_P``, ``MPC_Z_P``).
        most: Greatest correction in m/s, horizontally and vertically.
        speed: The correction never makes the set-point faster than this, in m/s.
        touchdown: Speed downwards in m/s for a vehicle that is still in the air when its reference
            has landed.

    Attributes:
        reference: Where the set-points so far lead: north, east, altitude.
    """

    def __init__(
        self,
        start: Vector,
        *,
        gains: tuple[float, float] = (0.95, 1.0),
        most: float = 0.5,
        speed: float = 0.95,
        touchdown: float = 0.5,
    ) -> None:
        self.reference = start
        self._gains = gains
        self._most = most
        self._speed = speed
        self._touchdown = touchdown

    def advance(self, setpoint: Vector, seconds: float) -> None:
        """Move the reference. On the ground it stands, as the platform's model does."""
        north, east, altitude = self.reference
        if altitude <= 0 and setpoint[2] >= 0:
            return
        self.reference = (
            north + setpoint[0] * seconds,
            east + setpoint[1] * seconds,
            max(0.0, altitude - setpoint[2] * seconds),
        )

    def steer(self, setpoint: Vector, position: Vector) -> Vector:
        """The velocity to ask for: the plan's, plus a correction towards the reference.

        Args:
            setpoint: The plan's: north, east, down in m/s.
            position: Where the vehicle is: north, east, altitude.
        """
        north = self._gains[0] * (self.reference[0] - position[0])
        east = self._gains[0] * (self.reference[1] - position[1])
        down = self._gains[1] * (position[2] - self.reference[2])
        size = math.hypot(north, east)
        part = min(1.0, self._most / size) if size else 0.0
        down = min(self._most, max(-self._most, down))
        if self.reference[2] <= 0 and setpoint[2] >= 0:
            return (north * part, east * part, self._touchdown)
        return _capped(setpoint, (north * part, east * part, down), self._speed)


class TakeOff:
    """PX4's take-off: after arming the rotors spool up, then the upward velocity is ramped.

    The ramp starts below zero, where no thrust is left, so that a vehicle stands for some time
    after it has been told to climb (PX4, ``src/modules/mc_pos_control/Takeoff/Takeoff.cpp``, with
    ``MPC_SPOOLUP_TIME``, ``MPC_TKO_RAMP_T``, ``MPC_Z_VEL_MAX_UP`` and ``MPC_Z_VEL_P_ACC``).

    Args:
        lag: Time constant of the vertical velocity in seconds, 1 / ``MPC_Z_VEL_P_ACC``.
        spool_up: Seconds from arming until the rotors are ready.
        ramp: Seconds that the ramp takes.
        fastest: Velocity upwards at its end, in m/s.
    """

    def __init__(
        self, lag: float, *, spool_up: float = 1.0, ramp: float = 3.0, fastest: float = 3.0
    ) -> None:
        self._ramp = ramp
        self._fastest = fastest
        self._lowest = -GRAVITY * lag
        self._waits = spool_up
        self._progress: float | None = None

    def limit(self, wants_up: bool, seconds: float) -> float:
        """The greatest velocity upwards now, in m/s; negative while the vehicle cannot lift off.

        Args:
            wants_up: Whether the set-point climbs.
            seconds: Time that passes.
        """
        self._waits = max(0.0, self._waits - seconds)
        if self._progress is None:
            if self._waits > 0 or not wants_up:
                return self._lowest
            self._progress = 0.0
        if self._progress < 1.0:
            share = seconds / self._ramp if self._ramp > seconds else 1.0
            self._progress = min(1.0, self._progress + share)
        return self._lowest + self._progress * (self._fastest - self._lowest)

    def land(self) -> None:
        """The vehicle has landed: the next take-off is ramped again."""
        self._progress = None


def _capped(setpoint: Vector, correction: Vector, speed: float) -> Vector:
    """A set-point with as much of a correction as the speed allows, but never without itself."""
    (n, e, d), (x, y, z) = setpoint, correction
    own = n * n + e * e + d * d
    square, cross = x * x + y * y + z * z, n * x + e * y + d * z
    over = own - max(speed * speed, own)
    part = 1.0
    if over + 2 * cross + square > 0:
        part = (-cross + math.sqrt(max(0.0, cross * cross - square * over))) / square
    return (n + part * x, e + part * y, d + part * z)
