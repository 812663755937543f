"""Plots as SVG, drawn by hand so that a page needs no plotting library and no script."""

from __future__ import annotations

import importlib.resources
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from vaso.report.axes import LETTER, Axes, make_axes
from vaso.report.marks import DASHES, SHAPES, mark
from vaso.report.markup import Markup, el
from vaso.report.palette import SERIES, variables

WIDTH, MEDIUM, NARROW, HEIGHT = 640, 470, 330, 230
MARKED = 60
FEW = 3
ROW = 22


@dataclass(frozen=True, slots=True)
class Point:
    """A point of a plot.

    Attributes:
        x: Position.
        y: Value.
        mark: Style of its mark: empty, ``bad`` or ``rejected``.
        title: Text shown when the pointer rests on it.
    """

    x: float
    y: float
    mark: str = ""
    title: str = ""


@dataclass(frozen=True, slots=True)
class Series:
    """A line of a plot.

    Attributes:
        points: In order of x.
        name: For the legend; a series without a name is not in it.
        style: Which colour, dash and mark, from 0; they repeat where there are more series.
        stairs: The value stays until the next point, instead of changing evenly.
        joined: False for marks without a line.
        marked: Positions of the points that get a mark; all of a few, none of many, where None.
        band: Lowest and highest value at each point, drawn as an area.
    """

    points: Sequence[Point]
    name: str = ""
    style: int = 0
    stairs: bool = False
    joined: bool = True
    marked: frozenset[int] | None = None
    band: Sequence[tuple[float, float]] = field(default=())


def plot(
    series: Sequence[Series],
    *,
    x_label: str,
    y_label: str,
    title: str = "",
    description: str = "",
    y_range: tuple[float, float] | None = None,
    x_start: float | None = None,
    percent: bool = False,
    limit: float | None = None,
    limit_label: str = "",
    whole: bool = False,
    log: bool = False,
    width: float = WIDTH,
    height: float = HEIGHT,
) -> Markup:
    """One or more lines over a common axis, as an ``svg`` element.

    Args:
        series: The lines; the first one is drawn first.
        x_label: Name of the x axis.
        y_label: Name of the y axis.
        title: What the plot shows, for people who cannot see it.
        description: What can be seen in it, for people who cannot see it.
        y_range: Lowest and highest value; from the points where left out.
        x_start: Where the x axis begins; at the first point where left out.
        percent: Label the y axis in per cent.
        limit: A dashed line at this value.
        limit_label: What stands at that line.
        whole: Only whole numbers on the x axis.
        log: A logarithmic x axis, for values above 0.
        width: In pixels.
        height: In pixels, without the legend.
    """
    rows = _legend_rows(series, width)
    xs = [p.x for s in series for p in s.points] + ([] if x_start is None else [x_start])
    axes = make_axes(
        _x_range(xs),
        y_range or _y_range(series, limit),
        size=(width, height),
        names=(x_label, y_label),
        percent=percent,
        whole=whole,
        log=log,
    )
    content = [*axes.markup, *_limit(limit, limit_label, axes)]
    opacity = 0.16 if len(series) <= FEW else 0.07
    content += [part for s in series for part in (*_band(s, axes, opacity), *_line(s, axes))]
    content += [part for s in series for part in _marks(s, axes)]
    shifted = el("g", content, transform=f"translate(0 {len(rows) * ROW})")
    total = height + len(rows) * ROW
    return el(
        "svg",
        el("title", title or f"{y_label} over {x_label}"),
        el("desc", description) if description else None,
        [part for n, row in enumerate(rows) for part in _legend_row(row, n * ROW + 15)],
        shifted,
        viewBox=f"0 0 {width:g} {total:g}",
        width=f"{width:g}",
        role="img",
        cls="vaso-plot",
    )


def responsive(series: Sequence[Series], *, width: int = WIDTH, **options: Any) -> Markup:
    """A plot for wide and one for narrow places; the page shows the one that fits.

    Args:
        series: The lines.
        width: Of the wide one in pixels: ``WIDTH`` or ``MEDIUM``, which the style sheet knows.
        **options: See :func:`plot`.
    """
    wide, narrow = (plot(series, width=w, **options) for w in (width, NARROW))
    both = [el("div", wide, cls="wide"), el("div", narrow, cls="narrow")]
    return el("div", both, cls=f"either at-{width}")


def plot_styles() -> str:
    """The style sheet of plots; it touches nothing but them."""
    css = importlib.resources.files("vaso.report").joinpath("plot.css").read_text(encoding="utf-8")
    return variables(".vaso-plot") + css


def _x_range(xs: Sequence[float]) -> tuple[float, float]:
    low, high = min(xs, default=0.0), max(xs, default=1.0)
    return low, high if high > low else low + 1


def _y_range(series: Sequence[Series], limit: float | None) -> tuple[float, float]:
    values = [p.y for s in series for p in s.points] + ([] if limit is None else [limit])
    low, high = min([0.0, *values]), max(values, default=1.0)
    return low, high + (high - low) * 0.12 or 1.0


def _limit(limit: float | None, label: str, axes: Axes) -> list[Markup]:
    if limit is None:
        return []
    y, end = axes.y(limit), axes.x.end
    text = el("text", label, x=end, y=y - 5, text_anchor="end", cls="limit-label")
    line = el("line", x1=axes.x.start, x2=end, y1=y, y2=y, cls="limit")
    return [line, text] if label else [line]


def _line(series: Series, axes: Axes) -> list[Markup]:
    if not series.joined or not series.points:
        return []
    path = _path([(p.x, p.y) for p in series.points], axes, series.stairs)
    return [
        el("path", d=f"M{path}", cls=f"curve {_colour(series)}", stroke_dasharray=_dash(series))
    ]


def _band(series: Series, axes: Axes, opacity: float) -> list[Markup]:
    if not series.band:
        return []
    xs = [p.x for p in series.points]
    low, high = ([b[side] for b in series.band] for side in (0, 1))
    there = _path(list(zip(xs, high, strict=True)), axes, series.stairs)
    back = _path(list(zip(xs, low, strict=True)), axes, series.stairs, reverse=True)
    area = el("path", d=f"M{there} L{back} Z", cls=f"band {_colour(series)}", fill_opacity=opacity)
    return [area, *_whisker(series, axes)]


def _whisker(series: Series, axes: Axes) -> list[Markup]:
    """The band at the end, where stairs have no width."""
    x = axes.x(series.points[-1].x)
    low, high = (axes.y(value) for value in series.band[-1])
    if low == high:
        return []
    ends = " ".join(f"M{x - 4:g} {y:g} H{x + 4:g}" for y in (low, high))
    return [el("path", d=f"M{x:g} {low:g} V{high:g} {ends}", cls=f"whisker {_colour(series)}")]


def _path(
    points: Sequence[tuple[float, float]], axes: Axes, stairs: bool, *, reverse: bool = False
) -> str:
    pixels = [(axes.x(x), axes.y(y)) for x, y in points]
    if stairs:
        corners = [(b[0], a[1]) for a, b in pairwise(pixels)]
        pixels = [p for pair in zip(pixels, [*corners, pixels[-1]], strict=True) for p in pair]
    order = reversed(pixels) if reverse else pixels
    return " L".join(f"{x:g} {y:g}" for x, y in order)


def _marks(series: Series, axes: Axes) -> list[Markup]:
    few = len(series.points) <= MARKED
    return [
        _mark(series, p, axes)
        for n, p in enumerate(series.points)
        if p.mark or (n in series.marked if series.marked is not None else few)
    ]


def _mark(series: Series, point: Point, axes: Axes) -> Markup:
    shape = SHAPES[series.style % len(SHAPES)]
    size = 4.5 if point.mark else 3.6
    cls = f"dot {_colour(series)} {point.mark}".strip()
    drawn = mark(shape, axes.x(point.x), axes.y(point.y), size, cls)
    return el("g", el("title", point.title), drawn) if point.title else drawn


def _colour(series: Series) -> str:
    return f"s{series.style % SERIES}"


def _dash(series: Series) -> str | None:
    return DASHES[series.style % len(DASHES)] or None


def _legend_rows(series: Sequence[Series], width: float) -> list[list[tuple[float, Series]]]:
    """The named series with their positions, broken into rows."""
    rows: list[list[tuple[float, Series]]] = []
    x = width
    for each in (s for s in series if s.name):
        wide = 44 + (len(each.name) + 2) * LETTER
        if not rows or x + wide > width:
            rows.append([])
            x = 8.0
        rows[-1].append((x, each))
        x += wide
    return rows


def _legend_row(row: Sequence[tuple[float, Series]], y: float) -> list[Markup]:
    parts: list[Markup] = []
    for x, series in row:
        shape, colour = SHAPES[series.style % len(SHAPES)], _colour(series)
        kind = series.points[0].mark if series.points and not series.joined else ""
        if series.joined:
            line = {"x1": x, "x2": x + 34, "y1": y - 4, "y2": y - 4}
            dash = _dash(series)
            parts.append(el("line", cls=f"curve {colour}", stroke_dasharray=dash, **line))
        parts.append(mark(shape, x + 17, y - 4, 3.6, f"dot {colour} {kind}".strip()))
        parts.append(el("text", series.name, x=round(x + 42, 1), y=y))
    return parts
