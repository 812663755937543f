"""The solid things of a ground scene: what is near, what is in the way, what hides what."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from vaso.simulation.geometry import (
    Point,
    Segment,
    contains,
    crosses,
    distance_to,
    edges,
    wrapped,
)
from vaso.simulation.scene import Scene

__all__ = ["Pose", "Solid", "World"]


@dataclass(frozen=True, slots=True)
class Pose:
    """Position in metres and heading in radians."""

    x: float
    y: float
    heading: float

    @property
    def at(self) -> Point:
        """The position."""
        return (self.x, self.y)

    def bearing(self, point: Point) -> float:
        """The angle to a point in (-pi, pi]; 0 is ahead, left is positive."""
        return wrapped(math.atan2(point[1] - self.y, point[0] - self.x) - self.heading)

    def local(self, point: Point) -> Point:
        """A point as metres ahead and metres to the left."""
        dx, dy = point[0] - self.x, point[1] - self.y
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return (dx * cos + dy * sin, dy * cos - dx * sin)


@dataclass(frozen=True)
class Solid:
    """Something that a robot cannot drive through: a wall, a polygon, or a disc.

    Attributes:
        name: What it is.
        outline: Its sides; none for a disc.
        polygon: Its corners, if it has an inside.
        middle: A point in it.
        reach: No point of it is farther than this from the middle.
        top: How high it reaches, in metres.
        hides: Whether things behind it cannot be seen.
    """

    name: str
    outline: tuple[Segment, ...]
    polygon: tuple[Point, ...]
    middle: Point
    reach: float
    top: float = math.inf
    hides: bool = True

    def distance(self, point: Point) -> float:
        """How far a point is from it; 0 inside."""
        if not self.outline:
            return max(0.0, math.dist(point, self.middle) - self.reach)
        if self.polygon and contains(self.polygon, point):
            return 0.0
        return min(distance_to(side, point) for side in self.outline)

    def is_within(self, pose: Pose, reach: float, half: float) -> bool:
        """Whether a part of it is in the strip ahead of a pose."""
        if not self.outline:
            ahead, left = pose.local(self.middle)
            gap = math.hypot(ahead - min(reach, max(0.0, ahead)), max(0.0, abs(left) - half))
            return gap < self.reach
        return any(
            _enters(pose.local(a), pose.local(b), (0.0, reach), (-half, half))
            for a, b in self.outline
        )


class World:
    """The solid things of a placed scene.

    Args:
        scene: A scene whose things are at their places.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.solids = tuple(_solids(scene))

    @cached_property
    def hiding(self) -> tuple[Solid, ...]:
        """What hides things behind it."""
        return tuple(s for s in self.solids if s.hides and s.outline)

    def near(self, point: Point, reach: float) -> list[Solid]:
        """The solids that may be within a distance of a point."""
        x, y = point
        return [
            s
            for s in self.solids
            if math.hypot(s.middle[0] - x, s.middle[1] - y) - s.reach <= reach
        ]

    def nearest(self, point: Point, solids: list[Solid]) -> tuple[float, str]:
        """Distance and name of the nearest one of some solids; infinite if there is none."""
        return min(((s.distance(point), s.name) for s in solids), default=(math.inf, ""))

    def is_clear(self, eye: Point, target: Point, top: float = 0.0) -> bool:
        """Whether something of a height can be seen: nothing opaque as high is in between.

        Args:
            eye: Where the camera is.
            target: Where the thing is.
            top: How high the thing reaches, in metres.
        """
        line = (eye, target)
        middle = ((eye[0] + target[0]) / 2, (eye[1] + target[1]) / 2)
        half = math.dist(eye, target) / 2
        for solid in self.hiding:
            if solid.top < top or math.dist(solid.middle, middle) > solid.reach + half:
                continue
            if solid.polygon and contains(solid.polygon, target):
                continue
            if any(crosses(line, side) for side in solid.outline):
                return False
        return True

    def is_free(self, start: Point, end: Point, radius: float) -> bool:
        """Whether a disc can move along a straight line."""
        count = max(1, math.ceil(math.dist(start, end) / radius))
        points = [
            (start[0] + (end[0] - start[0]) * i / count, start[1] + (end[1] - start[1]) * i / count)
            for i in range(count + 1)
        ]
        return all(self.nearest(p, self.near(p, radius))[0] >= radius for p in points)


def _solids(scene: Scene) -> Iterator[Solid]:
    for a, b in scene.wall_segments:
        middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        yield Solid("wall", ((a, b),), (), middle, math.dist(a, b) / 2)
    for piece in scene.furniture:
        corners = piece.polygon
        reach = max(math.dist(piece.at, c) for c in corners)
        yield Solid(
            piece.kind, edges(corners), corners, piece.at, reach, piece.top, hides=piece.hides
        )
    for item in scene.objects:
        if item.elevation == 0:
            yield Solid(item.kind, (), (), item.at, item.radius, item.top, hides=False)


def _enters(a: Point, b: Point, xs: tuple[float, float], ys: tuple[float, float]) -> bool:
    """Whether a segment has a point in an axis-parallel rectangle (Liang and Barsky, 1984)."""
    first, last = 0.0, 1.0
    for start, end, (low, high) in ((a[0], b[0], xs), (a[1], b[1], ys)):
        step = end - start
        if abs(step) < 1e-12:
            if not low < start < high:
                return False
            continue
        near, far = sorted(((low - start) / step, (high - start) / step))
        first, last = max(first, near), min(last, far)
        if first >= last:
            return False
    return True
