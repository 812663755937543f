"""What really happened in a simulated run, moment by moment, as data."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from vaso.simulation.camera import Camera
from vaso.simulation.geometry import Point
from vaso.simulation.scene import AirScene, Scene

__all__ = ["FlightMoment", "FlightTruth", "GroundMoment", "GroundTruth", "Vector"]

Vector: TypeAlias = tuple[float, float, float]


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", ser_json_inf_nan="strings")


class GroundMoment(_Model):
    """A ground robot at the end of one control period.

    Attributes:
        step: Number of the state, as in the log of the run.
        time: Seconds since the start.
        x: Metres.
        y: Metres.
        heading: Radians, not wrapped: a full turn to the left adds 2 pi.
        linear: True speed forwards in m/s.
        angular: True turn rate in rad/s.
        contact: What the robot touched in this period; empty for nothing.
        people: Where each person is; None for somebody who has left.
        nearest_person: Gap between the robot's and a person's body in metres; infinite without
            people.
        in_view: For each class of things that was asked for: whether it was in view.
        reported: And what the detector said.
        after_stop: True once the robot has been told to stop for good.
    """

    step: int
    time: float
    x: float
    y: float
    heading: float
    linear: float = 0.0
    angular: float = 0.0
    contact: str = ""
    people: tuple[Point | None, ...] = ()
    nearest_person: float = Field(default=math.inf, allow_inf_nan=True)
    in_view: dict[str, bool] = Field(default_factory=dict)
    reported: dict[str, bool] = Field(default_factory=dict)
    after_stop: bool = False

    @property
    def at(self) -> Point:
        """The position."""
        return (self.x, self.y)


class GroundTruth(_Model):
    """A run of the Jackal simulator.

    Attributes:
        scene: The scene as it was for this seed.
        seed: The seed.
        dt: Control period in seconds.
        radius: Of the robot's footprint in metres.
        moments: From the start on.
        camera: What the robot looked with.
    """

    scene: Scene
    seed: int
    dt: float
    radius: float
    moments: tuple[GroundMoment, ...]
    camera: Camera = Camera()

    @property
    def path(self) -> tuple[Point, ...]:
        """The robot's positions."""
        return tuple(m.at for m in self.moments)

    @property
    def path_length(self) -> float:
        """Metres driven, forwards and backwards."""
        return sum(math.dist(a, b) for a, b in pairwise(self.path))

    @property
    def contacts(self) -> tuple[GroundMoment, ...]:
        """The moments in which something was touched."""
        return tuple(m for m in self.moments if m.contact)

    @property
    def nearest_person(self) -> float:
        """The least gap between robot and person in metres; infinite without people."""
        return min((m.nearest_person for m in self.moments), default=math.inf)

    @property
    def turned(self) -> float:
        """Radians between the first and the last heading; left is positive."""
        return self.moments[-1].heading - self.moments[0].heading

    def first_in_view(self, kind: str) -> GroundMoment | None:
        """The first moment at which a class of things was in view, if it was asked for."""
        return next((m for m in self.moments if m.in_view.get(kind)), None)


class FlightMoment(_Model):
    """A quadcopter at the end of one control period.

    Attributes:
        step: Number of the state, as in the log of the run.
        time: Seconds since the start.
        north: Metres.
        east: Metres.
        altitude: Metres above the ground.
        velocity: True velocity (north, east, down) in m/s.
        setpoint: The plan's set-point in force.
        reference: Where the plan's set-points lead: north, east, altitude in metres.
        wind: Where the air goes, in m/s.
        highest: The greatest altitude so far, between samples too.
        is_on_ground: Whether it stands on the ground.
        after_stop: True once it has been told to land for good.
    """

    step: int
    time: float
    north: float
    east: float
    altitude: float
    velocity: Vector = (0.0, 0.0, 0.0)
    setpoint: Vector = (0.0, 0.0, 0.0)
    reference: Vector = (0.0, 0.0, 0.0)
    wind: Vector = (0.0, 0.0, 0.0)
    highest: float = 0.0
    is_on_ground: bool = True
    after_stop: bool = False

    @property
    def at(self) -> Point:
        """North and east."""
        return (self.north, self.east)

    @property
    def speed(self) -> float:
        """Metres per second."""
        return math.hypot(*self.velocity)


class FlightTruth(_Model):
    """A run of the PX4 simulator.

    Attributes:
        scene: The scene as it was for this seed.
        seed: The seed.
        dt: Control period in seconds.
        tracking: Whether the adapter followed the nominal path in closed loop.
        moments: One for each control period, from the start on.
        track: (time, north, east, altitude) ten times a second, for pictures.
        touchdowns: (time, sink rate in m/s) of each contact with the ground.
    """

    scene: AirScene
    seed: int
    dt: float
    tracking: bool
    moments: tuple[FlightMoment, ...]
    track: tuple[tuple[float, float, float, float], ...] = ()
    touchdowns: tuple[tuple[float, float], ...] = ()

    @property
    def path(self) -> tuple[Point, ...]:
        """North and east, ten times a second."""
        return tuple((north, east) for _, north, east, _ in self.track)

    @property
    def path_length(self) -> float:
        """Metres flown horizontally."""
        return sum(math.dist(a, b) for a, b in pairwise(self.path))

    @property
    def highest(self) -> float:
        """The greatest altitude in metres."""
        return self.moments[-1].highest

    @property
    def greatest_deviation(self) -> float:
        """The greatest distance from where the set-points lead, at a sample, in metres."""
        return max(
            math.dist((m.north, m.east, m.altitude), m.reference)
            for m in self.moments
            if not m.after_stop
        )
