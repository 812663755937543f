"""A vehicle that follows set-points, integrated in small steps: the definition, not its solution."""

import math
from dataclasses import dataclass

from vaso.platforms import Channel, Greatest, Position, Response, Speed, Velocity


def response(lags, accelerations=(math.inf, math.inf), floor=0.0):
    """Horizontal and vertical velocity as on the PX4, with other constants."""
    constants = list(zip(lags, accelerations, strict=True))
    return Response(
        channels=(
            channel("horizontal", (0, 1), *constants[0]),
            channel("vertical", (2,), *constants[1]),
        ),
        quantities={
            "altitude": Position(channel="vertical", factor=-1.0, floor=floor),
            "max_altitude": Greatest(of="altitude"),
            "linear_velocity": Speed(
                channels=("horizontal", "vertical"),
                unless_on=None if floor is None else "altitude",
            ),
            "sink": Velocity(channel="vertical"),
        },
    )


def channel(name, components, lag, acceleration):
    return Channel(
        name=name,
        parameter="velocity",
        components=components,
        lag=lag,
        acceleration=acceleration,
    )


@dataclass
class Vehicle:
    """One vehicle: a lag and an acceleration for each channel."""

    lags: tuple
    accelerations: tuple
    floor: float | None = 0.0
    height: float = 0.0
    highest: float = 0.0

    def __post_init__(self):
        self.velocity = [0.0, 0.0, 0.0]

    def follow(self, setpoint, seconds):
        """One step of the differential equation."""
        on_ground = self.floor is not None and self.height <= self.floor
        if on_ground and setpoint[2] >= 0:
            self.velocity = [0.0, 0.0, 0.0]
            return
        before = self.velocity[2]
        for parts, lag, limit in zip(((0, 1), (2,)), self.lags, self.accelerations, strict=True):
            self._approach(parts, setpoint, lag, limit, seconds)
        self.height -= (before + self.velocity[2]) / 2 * seconds
        if self.floor is not None and self.height <= self.floor:
            self.height = self.floor
            if self.velocity[2] > 0:
                self.velocity = [0.0, 0.0, 0.0]
        self.highest = max(self.highest, self.height)

    def _approach(self, parts, setpoint, lag, limit, seconds):
        error = before = math.hypot(*(setpoint[i] - self.velocity[i] for i in parts))
        pieces = math.ceil(min(64.0, 8 * seconds / lag)) if lag else 1
        for _ in range(pieces):
            error = _midpoint(error, lag, limit, seconds / pieces)
        for i in parts:
            left = error / before if before else 0.0
            self.velocity[i] = setpoint[i] - (setpoint[i] - self.velocity[i]) * left

    @property
    def values(self):
        grounded = self.floor is not None and self.height <= self.floor
        return {
            "altitude": self.height,
            "max_altitude": self.highest,
            "linear_velocity": 0.0 if grounded else math.hypot(*self.velocity),
            "sink": self.velocity[2],
        }


def _midpoint(error, lag, limit, seconds):
    """One step of ``error' = -min(error / lag, limit)`` with the midpoint method."""

    def rate(left):
        return min(left / lag if lag else math.inf, limit)

    if error <= 0 or math.isinf(rate(error)) or (lag and seconds > lag):
        return 0.0
    middle = max(0.0, error - rate(error) * seconds / 2)
    return max(0.0, error - (rate(middle) if lag else limit) * seconds)
