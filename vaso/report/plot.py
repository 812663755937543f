"""A line plot as SVG, drawn by hand so that a page needs no plotting library and no script."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from vaso.report.markup import Markup, el

WIDTH, HEIGHT = 640, 220
LEFT, RIGHT, TOP, BOTTOM = 56, 16, 14, 40
MARKED = 60


@dataclass(frozen=True, slots=True)
class Point:
    """A point of a plot.

    Attributes:
        x: Position.
        y: Value.
        mark: Style of its dot: empty, ``bad`` or ``rejected``.
        title: Text shown when the pointer rests on it.
        joined: False for points that the curve leaves out.
    """

    x: float
    y: float
    mark: str = ""
    title: str = ""
    joined: bool = True


@dataclass(frozen=True, slots=True)
class Scale:
    """Maps values to pixels."""

    low: float
    high: float
    start: float
    end: float

    def __call__(self, value: float) -> float:
        """The pixel of a value."""
        share = (value - self.low) / ((self.high - self.low) or 1.0)
        return round(self.start + share * (self.end - self.start), 1)


def line_plot(
    points: Sequence[Point],
    *,
    x_label: str,
    y_label: str,
    y_range: tuple[float, float] | None = None,
    percent: bool = False,
    limit: float | None = None,
    whole: bool = False,
) -> Markup:
    """A curve through points.

    Args:
        points: In order of x.
        x_label: Name of the x axis.
        y_label: Name of the y axis.
        y_range: Lowest and highest value; from the points where left out.
        percent: Label the y axis in per cent.
        limit: A dashed line at this value.
        whole: Only whole numbers on the x axis.
    """
    low, high = y_range or _range([p.y for p in points] + ([limit] if limit is not None else []))
    first, last = points[0].x, points[-1].x
    x = Scale(first, last if last > first else first + 1, LEFT, WIDTH - RIGHT)
    y = Scale(low, high, HEIGHT - BOTTOM, TOP)
    parts = [*_y_axis(y, percent), *_x_axis(x, whole), *_names(x_label, y_label)]
    if limit is not None:
        parts.append(el("line", x1=LEFT, x2=WIDTH - RIGHT, y1=y(limit), y2=y(limit), cls="limit"))
    curve = " ".join(f"{x(p.x)},{y(p.y)}" for p in points if p.joined)
    parts.append(el("polyline", points=curve, cls="curve"))
    parts += [_dot(p, x, y) for p in points if p.mark or len(points) <= MARKED]
    svg = el(
        "svg",
        parts,
        viewBox=f"0 0 {WIDTH} {HEIGHT}",
        width=WIDTH,
        role="img",
        aria_label=f"{y_label} over {x_label}",
        cls="plot",
    )
    return el("div", svg, cls="scroll")


def _range(values: list[float]) -> tuple[float, float]:
    low, high = min(0.0, *values), max(values)
    return low, high + (high - low) * 0.12 or 1.0


def _dot(point: Point, x: Scale, y: Scale) -> Markup:
    title = [el("title", point.title)] if point.title else []
    radius = 4.5 if point.mark else 3
    center = el("circle", cx=x(point.x), cy=y(point.y), r=radius, cls=f"dot {point.mark}".strip())
    return el("g", title, center)


def _ticks(scale: Scale, count: int) -> list[float]:
    step = _nice((scale.high - scale.low) / count)
    first = -(-scale.low // step)
    ticks = [(first + i) * step for i in range(count + 2)]
    return [t for t in ticks if t <= scale.high + step * 1e-6]


def _nice(step: float) -> float:
    """The next of 1, 2, 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(m * power for m in (1, 2, 5, 10) if m * power >= step * (1 - 1e-9))


def _y_axis(y: Scale, percent: bool) -> list[Markup]:
    parts = []
    for tick in _ticks(y, 4):
        label = f"{tick * 100:.0f}%" if percent else f"{tick:.6g}"
        parts.append(el("line", x1=LEFT, x2=WIDTH - RIGHT, y1=y(tick), y2=y(tick), cls="axis"))
        parts.append(el("text", label, x=LEFT - 8, y=y(tick) + 4, text_anchor="end", cls="soft"))
    return parts


def _x_axis(x: Scale, whole: bool) -> list[Markup]:
    ticks = [t for t in _ticks(x, 8) if not whole or t == int(t)]
    return [
        el("text", f"{t:.6g}", x=x(t), y=HEIGHT - BOTTOM + 16, text_anchor="middle", cls="soft")
        for t in ticks
    ]


def _names(x_label: str, y_label: str) -> list[Markup]:
    middle = (LEFT + WIDTH - RIGHT) / 2
    side = (TOP + HEIGHT - BOTTOM) / 2
    return [
        el("text", x_label, x=middle, y=HEIGHT - 6, text_anchor="middle", cls="soft"),
        el(
            "text",
            y_label,
            transform=f"translate(13 {side}) rotate(-90)",
            text_anchor="middle",
            cls="soft",
        ),
    ]
