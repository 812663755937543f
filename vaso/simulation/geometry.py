"""Plane geometry of scenes: points, segments, polygons; metres and radians."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TypeAlias

Point: TypeAlias = tuple[float, float]
Segment: TypeAlias = tuple[Point, Point]

TINY = 1e-9


def nearest_on(segment: Segment, point: Point) -> Point:
    """The point of a segment that is nearest to a point."""
    (ax, ay), (bx, by) = segment
    dx, dy = bx - ax, by - ay
    length = dx * dx + dy * dy
    if length < TINY * TINY:
        return segment[0]
    part = ((point[0] - ax) * dx + (point[1] - ay) * dy) / length
    part = min(1.0, max(0.0, part))
    return (ax + part * dx, ay + part * dy)


def distance_to(segment: Segment, point: Point) -> float:
    """Distance of a point from a segment."""
    return math.dist(nearest_on(segment, point), point)


def crosses(one: Segment, other: Segment) -> bool:
    """Whether two segments have a point in common (touching counts)."""
    ((ax, ay), (bx, by)), ((cx, cy), (dx, dy)) = one, other
    if max(ax, bx) < min(cx, dx) or max(cx, dx) < min(ax, bx):
        return False
    if max(ay, by) < min(cy, dy) or max(cy, dy) < min(ay, by):
        return False
    ux, uy, vx, vy = bx - ax, by - ay, dx - cx, dy - cy
    if (ux * (cy - ay) - uy * (cx - ax)) * (ux * (dy - ay) - uy * (dx - ax)) > 0:
        return False
    return (vx * (ay - cy) - vy * (ax - cx)) * (vx * (by - cy) - vy * (bx - cx)) <= 0


def edges(polygon: Sequence[Point]) -> tuple[Segment, ...]:
    """The sides of a closed polygon."""
    return tuple(zip(polygon, [*polygon[1:], polygon[0]], strict=True))


def contains(polygon: Sequence[Point], point: Point) -> bool:
    """Whether a point is inside a polygon (even-odd rule)."""
    x, y = point
    inside = False
    for (ax, ay), (bx, by) in edges(polygon):
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            inside = not inside
    return inside


def rectangle(at: Point, size: Point, heading: float = 0.0) -> tuple[Point, ...]:
    """The corners of a rectangle about its centre, turned by ``heading`` radians."""
    cos, sin = math.cos(heading), math.sin(heading)
    along, across = size[0] / 2, size[1] / 2
    halves = [(along, across), (-along, across), (-along, -across), (along, -across)]
    return tuple((at[0] + u * cos - v * sin, at[1] + u * sin + v * cos) for u, v in halves)


def without(segment: Segment, gaps: Iterable[Segment], tolerance: float = 0.05) -> list[Segment]:
    """What is left of a wall when gaps (doorways) that lie on it are cut out.

    Args:
        segment: The wall.
        gaps: Segments; those that do not lie on the wall within the tolerance are left alone.
        tolerance: Metres.
    """
    (ax, ay), (bx, by) = segment
    length = math.dist(*segment)
    if length < TINY:
        return []
    ux, uy = (bx - ax) / length, (by - ay) / length
    left = [(0.0, length)]
    for gap in gaps:
        if any(abs((x - ax) * uy - (y - ay) * ux) > tolerance for x, y in gap):
            continue
        low, high = sorted((x - ax) * ux + (y - ay) * uy for x, y in gap)
        parts = [[(s, min(e, low)), (max(s, high), e)] for s, e in left]
        left = [(s, e) for pair in parts for s, e in pair if e - s > TINY]
    return [((ax + s * ux, ay + s * uy), (ax + e * ux, ay + e * uy)) for s, e in left]


def wrapped(angle: float) -> float:
    """The same angle in (-pi, pi]."""
    return math.atan2(math.sin(angle), math.cos(angle))
