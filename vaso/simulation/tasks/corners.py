"""The corners of a flown polygon, found from the path alone.

A path is simplified to the polygon that it follows within a tolerance (Ramer, 1972; Douglas &
Peucker, 1973); corners that are hardly a change of direction are dropped. So it does not matter
where on a side the path starts, which way round it goes, or how the polygon is turned.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from vaso.simulation.geometry import Point, distance_to

__all__ = ["corners_of", "is_clockwise", "is_right_angled", "sides_of"]

STRAIGHT = math.radians(30.0)
RIGHT = math.radians(90.0)
MOST = 60
"""A path that needs more corners winds too much to be a polygon, and is left as it is."""


def corners_of(path: Sequence[Point], tolerance: float) -> list[Point]:
    """The corners of a closed path, in the order in which it passes them.

    Args:
        path: Points, dense compared with the tolerance; the last is near the first.
        tolerance: How far the path may be from the polygon, in metres.
    """
    if len(path) < 3:
        return list(path)
    kept = _simplified([*path, path[0]], tolerance)[:-1]
    while 2 < len(kept) <= MOST:
        bends = [_bend(kept, i) for i in range(len(kept))]
        least = min(range(len(kept)), key=bends.__getitem__)
        short = _short_side(kept, tolerance)
        if bends[least] < STRAIGHT:
            del kept[least]
        elif short is not None:
            del kept[short]
        else:
            break
    return kept


def sides_of(corners: Sequence[Point]) -> list[float]:
    """The lengths of the sides of a polygon."""
    return [math.dist(a, b) for a, b in zip(corners, [*corners[1:], *corners[:1]], strict=True)]


def is_clockwise(corners: Sequence[Point]) -> bool:
    """Whether a path on (north, east) goes round clockwise, seen from above."""
    area = sum(
        a[0] * b[1] - a[1] * b[0]
        for a, b in zip(corners, [*corners[1:], *corners[:1]], strict=True)
    )
    return area > 0  # x is north and y is east, so left and right are exchanged


def is_right_angled(corners: Sequence[Point], within: float = math.radians(20.0)) -> bool:
    """Whether all changes of direction are right angles, within a tolerance in radians."""
    return all(abs(_bend(corners, i) - RIGHT) <= within for i in range(len(corners)))


def _simplified(path: Sequence[Point], tolerance: float) -> list[Point]:
    """Ramer's algorithm; a loop is divided first at the point that is farthest from its ends."""
    kept = {0, len(path) - 1}
    parts = [(0, len(path) - 1)]
    while parts:
        start, end = parts.pop()
        far = max(
            range(start + 1, end),
            key=lambda i: _gap(path[start], path[end], path[i], tolerance),
            default=start,
        )
        if far > start and _gap(path[start], path[end], path[far], tolerance) > tolerance:
            kept.add(far)
            parts += [(start, far), (far, end)]
    return [path[i] for i in sorted(kept)]


def _gap(start: Point, end: Point, point: Point, tolerance: float) -> float:
    """Distance of a point from a line; from the start of one that is hardly longer than a point."""
    if math.dist(start, end) < tolerance:
        return math.dist(start, point)
    return distance_to((start, end), point)


def _bend(corners: Sequence[Point], index: int) -> float:
    """The change of direction at a corner, in radians."""
    before, here = corners[index - 1], corners[index]
    after = corners[(index + 1) % len(corners)]
    one = math.atan2(here[1] - before[1], here[0] - before[0])
    other = math.atan2(after[1] - here[1], after[0] - here[0])
    return abs(math.atan2(math.sin(other - one), math.cos(other - one)))


def _short_side(corners: Sequence[Point], tolerance: float) -> int | None:
    """The end of a side that is no longer than the tolerance: start and end of a loop, mostly."""
    lengths = sides_of(corners)
    found = next((i for i, length in enumerate(lengths) if length <= tolerance), None)
    return None if found is None else (found + 1) % len(corners) or found
