"""Where a vehicle is from its take-off point, on its own clock."""

from __future__ import annotations

import math
import time
from collections import deque

from vaso.modules.robots.px4_mavlink import Motion, Vehicle
from vaso.modules.robots.px4_path import Vector

__all__ = ["Track"]

AIRBORNE_M = 0.25  # above the noise of an estimator at rest
CLOSE_M = 1.0  # below this, a vehicle that disarms itself on its way down has landed
LEAST_M = 0.001  # the least altitude of a vehicle that is not on the ground
EXTRAPOLATION_S = 0.1  # the vehicle's clock goes on for so long without a message


class Track:
    """Follows a vehicle's position messages.

    Args:
        vehicle: The vehicle.

    Attributes:
        home: The take-off point in the vehicle's own frame. Its ``down`` is not 0 in general.
        airborne: Whether the vehicle has come off the ground since it was armed.
    """

    def __init__(self, vehicle: Vehicle) -> None:
        self.home: Vector | None = None
        self.airborne = False
        self._vehicle = vehicle
        self._recent: deque[Vector] = deque(maxlen=20)
        self._last: Motion | None = None
        self._clock = 0.0
        self._start = 0.0
        self._highest = 0.0

    def observe(self) -> float:
        """Take in the newest position.

        Returns:
            Seconds that have passed on the vehicle's clock since the last call.
        """
        motion = self._vehicle.motion
        if motion is None:
            return 0.0
        if motion is not self._last:
            self._last = motion
            self._recent.append(motion.position)
            if self.airborne:
                self._highest = max(self._highest, self.altitude)
        since = min(time.monotonic() - motion.received, EXTRAPOLATION_S)
        passed = max(0.0, motion.time + since - self._clock)
        self._clock += passed
        return passed

    def set_home(self, *, anew: bool) -> None:
        """Take the mean of the last positions for the take-off point.

        Args:
            anew: False for a second take-off in a flight: only the ground's height is renewed, and
                time goes on.
        """
        mean = [sum(axis) / len(self._recent) for axis in zip(*self._recent, strict=True)]
        if anew or self.home is None:
            self.home = (mean[0], mean[1], mean[2])
            self._start = self._clock
        else:
            self.home = (self.home[0], self.home[1], mean[2])

    @property
    def time(self) -> float:
        """Seconds on the vehicle's clock since the flight began."""
        return self._clock - self._start

    @property
    def place(self) -> Vector | None:
        """Position from the take-off point."""
        motion = self._vehicle.motion
        if motion is None or self.home is None:
            return None
        return _minus(motion.position, self.home)

    @property
    def altitude(self) -> float:
        """Metres above the take-off point, as measured."""
        return -self.place[2] if self.place is not None else 0.0

    @property
    def grounded(self) -> bool:
        """Whether the vehicle stands on the ground: it says so, or has not left it, or is off."""
        return not self.airborne or not self._vehicle.armed or bool(self._vehicle.landed)

    def look_for_lift(self) -> None:
        """Notice that the vehicle has come off the ground."""
        if self.altitude > AIRBORNE_M and not self._vehicle.landed:
            self.airborne = True

    def has_come_down(self) -> bool:
        """Whether the vehicle has disarmed because it has landed, so far as one can tell."""
        return not self._vehicle.armed and (bool(self._vehicle.landed) or self.altitude < CLOSE_M)

    def measured(self) -> dict[str, float]:
        """The platform's numbers, and the position, in metres and m/s.

        On the ground, altitude and velocity are 0: an estimator at rest drifts. In the air the
        altitude is above 0 for the same reason.
        """
        motion, place = self._vehicle.motion, self.place
        if motion is None or place is None:
            return {}
        velocity = (0.0, 0.0, 0.0) if self.grounded else motion.velocity
        altitude = 0.0 if self.grounded else max(LEAST_M, self.altitude)
        return {
            "altitude": altitude,
            "max_altitude": max(self._highest, altitude),
            "linear_velocity": math.hypot(*velocity),
            "x": place[0],
            "y": place[1],
            "z": place[2],
        }


def _minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])
