"""What a camera has in view: field of view, range, and what hides what. Without errors."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pydantic import Field

from vaso.simulation.geometry import Point
from vaso.simulation.names import OBSTACLE, PERSON, kind_of
from vaso.simulation.people import PERSON_RADIUS
from vaso.simulation.things import Part
from vaso.simulation.world import Pose, World

__all__ = ["Camera", "Frame"]


class Camera(Part):
    """A forward camera, and the range sensor that looks for obstacles.

    Attributes:
        field_of_view: Degrees, horizontally; 69 is an Intel RealSense D435's colour camera.
        distance: Nothing farther than this is detected, in metres.
        mount: How far ahead of the robot's middle the camera is, in metres.
        obstacle_distance: Something solid within this distance ahead of the robot's middle, in the
            strip that it is about to drive through, is an obstacle. Metres.
        obstacle_width: The width of that strip, in metres.
        people_are_obstacles: Whether people in that strip count as obstacles, too; by default a
            person is reported as a person only.
    """

    field_of_view: float = Field(default=69.0, gt=0, le=360)
    distance: float = Field(default=5.0, gt=0)
    mount: float = 0.2
    obstacle_distance: float = Field(default=0.8, gt=0)
    obstacle_width: float = Field(default=0.8, gt=0)
    people_are_obstacles: bool = False

    def sees(self, kind: str, world: World, frame: Frame) -> bool:
        """Whether something of a kind is in view, or is in the way.

        Args:
            kind: A class of things, as :func:`~vaso.simulation.names.kind_of` writes it.
            world: The solid things.
            frame: Where robot and people are.
        """
        if kind == OBSTACLE:
            return self._is_blocked(world, frame)
        eye = self._eye(frame.pose)
        things = _things(kind, world, frame.people)
        return any(self._has(eye, points, top, world) for points, top in things)

    def covers(self, eye: Pose, point: Point) -> bool:
        """Whether a point is in the field of view and near enough."""
        if math.dist(eye.at, point) > self.distance:
            return False
        return abs(eye.bearing(point)) <= math.radians(self.field_of_view) / 2

    def _eye(self, pose: Pose) -> Pose:
        x = pose.x + self.mount * math.cos(pose.heading)
        y = pose.y + self.mount * math.sin(pose.heading)
        return Pose(x, y, pose.heading)

    def _has(self, eye: Pose, points: Sequence[Point], top: float, world: World) -> bool:
        """A thing is seen by its middle (the first point), or by half of its points."""
        if math.dist(eye.at, points[0]) > self.distance + 2.0:
            return False
        seen = 0
        for number, point in enumerate(points):
            if self.covers(eye, point) and world.is_clear(eye.at, point, top):
                if number == 0:
                    return True
                seen += 1
        return 2 * seen >= len(points)

    def _is_blocked(self, world: World, frame: Frame) -> bool:
        reach, half = self.obstacle_distance, self.obstacle_width / 2
        pose = frame.pose
        near = world.near(pose.at, math.hypot(reach, half))
        if any(solid.is_within(pose, reach, half) for solid in near):
            return True
        if not self.people_are_obstacles:
            return False
        spots = (pose.local(p) for p in frame.people if p is not None)
        return any(
            -PERSON_RADIUS < ahead < reach + PERSON_RADIUS and abs(left) < half + PERSON_RADIUS
            for ahead, left in spots
        )


@dataclass(frozen=True, slots=True)
class Frame:
    """Where robot and people are when an image is taken.

    Attributes:
        number: Of the control period.
        pose: The robot's.
        people: Each person's position; None for somebody who has left.
    """

    number: int
    pose: Pose
    people: tuple[Point | None, ...]


def _things(
    kind: str, world: World, people: Sequence[Point | None]
) -> Iterator[tuple[list[Point], float]]:
    """The points by which each thing of a kind can be seen, its middle first, and its height."""
    scene = world.scene
    if kind == PERSON:
        yield from ((_round(p, PERSON_RADIUS), 1.7) for p in people if p is not None)
    for item in scene.objects:
        if kind_of(item.kind) == kind:
            yield _round(item.at, item.radius), item.top
    for piece in scene.furniture:
        if kind in (kind_of(piece.kind), "furniture"):
            yield [piece.at, *piece.polygon], piece.top
    for door in scene.doorways:
        if kind in (kind_of(door.name), "doorway"):
            yield [door.at], 2.0


def _round(at: Point, radius: float) -> list[Point]:
    x, y = at
    return [at, (x + radius, y), (x, y + radius), (x - radius, y), (x, y - radius)]
