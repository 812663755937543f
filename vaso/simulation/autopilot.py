"""Between a plan's set-points and the vehicle: the adapter's position loop, and PX4's take-off.

The adapter of a real vehicle (``docs/robots/px4.md``) does not send a plan's velocities as they
are: take-off ramps, drag and wind would carry the vehicle metres away from where they lead. It
integrates them to a nominal path and adds a bounded correction towards it; where the plan stands
still, it asks PX4 to hold the position. This is the same law, with the same numbers.
"""

from __future__ import annotations

import math

from vaso.simulation.truth import Vector

__all__ = ["AIRBORNE", "LEAST_CLIMB", "ZERO", "TakeOff", "Tracker"]

ZERO: Vector = (0.0, 0.0, 0.0)
GRAVITY = 9.80665

GAIN = 0.6
"""Correction in m/s for each metre."""

CORRECTION = 0.3
"""The greatest correction in m/s."""

TRACKING_SPEED = 0.9
"""Corrections do not make the vehicle faster than this, in m/s."""

LAG = 0.5
"""Seconds by which the vehicle is expected behind the nominal path."""

HOLD = (0.95, 1.0)
"""PX4's own position loop, horizontally and vertically (``MPC_XY_P``, ``MPC_Z_P``), in 1/s."""

REACH = 0.5
"""A position set-point is no farther away than this, in metres."""

AIRBORNE = 0.25
"""Above this altitude in metres, the vehicle has come off the ground."""

LEAST_CLIMB = 0.3
"""The least speed upwards, in m/s, with which a vehicle is brought off the ground."""

TOUCHDOWN = 0.5
"""Speed downwards, in m/s, of a vehicle in the air whose nominal path has landed."""


class Tracker:
    """The nominal path of a plan's set-points, and the velocity that keeps a vehicle on it.

    Args:
        start: Position at the beginning: north, east, altitude in metres.
        touchdown: Speed downwards for a vehicle that is in the air when its path has landed.

    Attributes:
        reference: Where the set-points so far lead: north, east, altitude.
    """

    def __init__(self, start: Vector, *, touchdown: float = TOUCHDOWN) -> None:
        self.reference = start
        self._expected = start
        self._touchdown = touchdown

    def lifts_off(self, setpoint: Vector) -> bool:
        """Whether a set-point leads off the ground."""
        return self.reference[2] <= 0 and setpoint[2] < 0

    def advance(self, setpoint: Vector, seconds: float) -> None:
        """Move along the path. On the ground it stands, as in the platform's model."""
        north, east, altitude = self.reference
        if altitude > 0 or setpoint[2] < 0:
            self.reference = (
                north + setpoint[0] * seconds,
                east + setpoint[1] * seconds,
                max(0.0, round(altitude - setpoint[2] * seconds, 9)),
            )
        share = -math.expm1(-seconds / LAG)
        (x, y, z), (n, e, d) = self._expected, self.reference
        self._expected = (x + (n - x) * share, y + (e - y) * share, z + (d - z) * share)

    def steer(self, setpoint: Vector, position: Vector) -> Vector:
        """The velocity to ask for, north, east, down in m/s.

        Args:
            setpoint: The plan's.
            position: Where the vehicle is: north, east, altitude.
        """
        has_landed = self.reference[2] <= 0 and setpoint[2] >= 0
        if has_landed or setpoint == ZERO:
            north, east, down = _limited(_between(position, self.reference), REACH)
            sink = self._touchdown if has_landed else HOLD[1] * down
            return (HOLD[0] * north, HOLD[0] * east, sink)
        x, y, z = _limited(_between(position, self._expected, GAIN), CORRECTION)
        wanted = (setpoint[0] + x, setpoint[1] + y, setpoint[2] + z)
        return _limited(wanted, max(TRACKING_SPEED, math.hypot(*setpoint)))


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


def _between(here: Vector, there: Vector, factor: float = 1.0) -> Vector:
    """North, east and down from one position to another, times a factor."""
    north, east, up = there[0] - here[0], there[1] - here[1], there[2] - here[2]
    return (factor * north, factor * east, -factor * up)


def _limited(vector: Vector, most: float) -> Vector:
    length = math.hypot(*vector)
    if length <= most:
        return vector
    part = most / length
    return (vector[0] * part, vector[1] * part, vector[2] * part)
