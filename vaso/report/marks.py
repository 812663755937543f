"""Marks of a plot, one shape a series, so that no reader depends on colour."""

from __future__ import annotations

import math
from collections.abc import Sequence

from vaso.report.markup import Markup, el

SHAPES = ("circle", "square", "triangle", "diamond", "plus", "cross", "star", "down")
DASHES = ("", "7 4", "2 3", "9 3 2 3", "5 2", "12 4", "1 4", "9 3 2 3 2 3")


def mark(shape: str, x: float, y: float, size: float, cls: str) -> Markup:
    """A mark around a point.

    Args:
        shape: One of ``SHAPES``.
        x: Centre, in pixels.
        y: Centre, in pixels.
        size: About half of its width.
        cls: Its style.
    """
    if shape == "circle":
        return el("circle", cx=_short(x), cy=_short(y), r=size, cls=cls)
    return el("path", d=_path(shape, x, y, size), cls=cls)


def _path(shape: str, x: float, y: float, r: float) -> str:
    if shape == "plus":
        return _strokes([(x - r, y), (x + r, y)], [(x, y - r), (x, y + r)])
    if shape == "cross":
        d = r * 0.8
        return _strokes([(x - d, y - d), (x + d, y + d)], [(x - d, y + d), (x + d, y - d)])
    if shape == "star":
        return _closed(x, y, [1.3 * r, 0.55 * r] * 5, -90)
    corners, turn = {"square": (4, 45), "triangle": (3, -90), "diamond": (4, 0), "down": (3, 90)}[
        shape
    ]
    return _closed(x, y, [1.25 * r] * corners, turn)


def _closed(x: float, y: float, radii: Sequence[float], turn: float) -> str:
    angles = [math.radians(turn + 360 * i / len(radii)) for i in range(len(radii))]
    points = [
        (x + r * math.cos(a), y + r * math.sin(a)) for r, a in zip(radii, angles, strict=True)
    ]
    return _strokes(points) + " Z"


def _strokes(*lines: Sequence[tuple[float, float]]) -> str:
    return " ".join("M" + " L".join(f"{_short(x)} {_short(y)}" for x, y in line) for line in lines)


def _short(pixel: float) -> str:
    return f"{pixel:.1f}".removesuffix(".0")
