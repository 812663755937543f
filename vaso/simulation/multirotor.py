"""A multirotor as a point that follows velocity set-points, with drag, wind and the ground.

    dv/dt = limited((u - v) / lag) + drag * (wind - v)

u is the set-point, the limit is on the size of the controller's acceleration, horizontally and
vertically. This is what is left of a quadcopter when attitude control is much faster than velocity
control: PX4's velocity controller without its integral and derivative parts.
"""

from __future__ import annotations

import math

from pydantic import Field

from vaso.platforms import Platform
from vaso.simulation.autopilot import ZERO, TakeOff
from vaso.simulation.things import NonNegative, Part
from vaso.simulation.truth import Vector

__all__ = ["Body", "Multirotor"]


class Body(Part):
    """What a vehicle can do.

    Attributes:
        lags: Time constants of the horizontal and the vertical velocity in seconds.
        drag: Acceleration in m/s² for each m/s of horizontal and of vertical air speed, in 1/s.
        horizontal: Greatest acceleration that the controller asks for, in m/s² (``MPC_ACC_HOR``).
        up: The same upwards (``MPC_ACC_UP_MAX``).
        down: The same downwards (``MPC_ACC_DOWN_MAX``).
    """

    lags: tuple[float, float] = (0.56, 0.25)
    drag: tuple[NonNegative, NonNegative] = (0.1, 0.1)
    horizontal: float = Field(default=5.0, gt=0)
    up: float = Field(default=4.0, gt=0)
    down: float = Field(default=3.0, gt=0)

    @classmethod
    def of(cls, platform: Platform) -> Body:
        """One with the lags of a platform's response: the slowest vehicle that it allows."""
        assert platform.response is not None
        horizontal, vertical = platform.response.channels
        return cls(lags=(horizontal.lags[1], vertical.lags[1]))


class Multirotor:
    """One vehicle.

    Args:
        body: What it can do.
        start: Where it stands: north, east, altitude 0.
        take_off: Its take-off ramp, if it has one.

    Attributes:
        position: North, east, altitude in metres.
        velocity: North, east, down in m/s.
        highest: The greatest altitude so far.
        is_on_ground: Whether it stands.
        touchdowns: (time, sink rate in m/s) of each contact with the ground.
    """

    def __init__(self, body: Body, start: Vector, take_off: TakeOff | None = None) -> None:
        self.position = start
        self.velocity = ZERO
        self.highest = start[2]
        self.is_on_ground = start[2] <= 0
        self.touchdowns: list[tuple[float, float]] = []
        self._body = body
        self._take_off = take_off
        self._time = 0.0

    def follow(self, setpoint: Vector, wind: Vector, seconds: float) -> None:
        """One sub-step under a set-point (midpoint method).

        Args:
            setpoint: North, east, down in m/s.
            wind: Where the air goes.
            seconds: Length of the sub-step; much shorter than the lags.
        """
        self._time += seconds
        if self._take_off is not None:
            limit = self._take_off.limit(setpoint[2] < 0, seconds)
            setpoint = (setpoint[0], setpoint[1], max(setpoint[2], -limit))
        if self.is_on_ground and setpoint[2] >= 0:
            self.velocity = ZERO
            return
        before = self.velocity
        middle = _moved(before, self._force(before, setpoint, wind), seconds / 2)
        self.velocity = _moved(before, self._force(middle, setpoint, wind), seconds)
        north, east, down = ((a + b) / 2 for a, b in zip(before, self.velocity, strict=True))
        altitude = self.position[2] - down * seconds
        self.position = (
            self.position[0] + north * seconds,
            self.position[1] + east * seconds,
            max(0.0, altitude),
        )
        self._meet_ground(altitude)
        self.highest = max(self.highest, altitude)

    def _meet_ground(self, altitude: float) -> None:
        was_on_ground, self.is_on_ground = self.is_on_ground, altitude <= 0
        if altitude > 0:
            return
        if not was_on_ground:
            self.touchdowns.append((round(self._time, 9), self.velocity[2]))
            if self._take_off is not None:
                self._take_off.land()
        self.velocity = ZERO

    def _force(self, velocity: Vector, setpoint: Vector, wind: Vector) -> Vector:
        """The acceleration: the controller's, within its limits, and the air's."""
        body = self._body
        north = (setpoint[0] - velocity[0]) / body.lags[0]
        east = (setpoint[1] - velocity[1]) / body.lags[0]
        down = (setpoint[2] - velocity[2]) / body.lags[1]
        size = math.hypot(north, east)
        if size > body.horizontal:
            north, east = north * body.horizontal / size, east * body.horizontal / size
        down = min(body.down, max(-body.up, down))
        level, upright = body.drag
        return (
            north + level * (wind[0] - velocity[0]),
            east + level * (wind[1] - velocity[1]),
            down + upright * (wind[2] - velocity[2]),
        )


def _moved(velocity: Vector, rate: Vector, seconds: float) -> Vector:
    return (
        velocity[0] + rate[0] * seconds,
        velocity[1] + rate[1] * seconds,
        velocity[2] + rate[2] * seconds,
    )
