"""How fast optimizers get somewhere: a line for each, the mean over seeds, a band of ± sd."""

from __future__ import annotations

import math
import statistics
from bisect import bisect_right
from collections.abc import Mapping, Sequence

from vaso.report.markup import Markup, el
from vaso.report.plot import WIDTH, Point, Series, plot, plot_styles

UNEVEN = 6
Curve = Sequence[tuple[float, float]]


def convergence_svg(
    curves: Mapping[str, Sequence[Curve]],
    *,
    x_label: str = "loss calls",
    y_label: str = "safety",
    title: str = "",
    width: float = WIDTH,
    percent: bool = True,
    y_range: tuple[float, float] | None = (0.0, 1.0),
    log: bool | None = None,
) -> Markup:
    """A convergence plot that compares optimizers, as one ``svg`` element with its styles inside.

    The value of a curve stays until its next point: it is the best so far. Over several seeds a
    line is the mean and a band one standard deviation of the sample to each side; a seed whose run
    is over counts with its last value. A line ends where the longest of its runs does. The series
    differ in colour (also for the colour-blind), dash and mark; light and dark are the viewer's.

    The result is a string, to be put in a page or a file; as the last expression of a notebook cell
    it shows itself.

    Args:
        curves: For each optimizer, in the order of the legend, a curve for each seed: points
            ``(spent, value)`` in order of what was spent. Curves without points count for nothing.
        x_label: What was spent.
        y_label: What is compared.
        title: Says what the plot shows, for people who cannot see it.
        width: In pixels; it shrinks where there is less room.
        percent: Values are shares in [0, 1].
        y_range: Lowest and highest value; from the curves where None.
        log: A logarithmic x axis; by default where some lines are much shorter than others.
    """
    found = [(name, [c for c in seeds if c]) for name, seeds in curves.items()]
    top = 1.0 if percent else math.inf
    series = [_series(name, n, seeds, top) for n, (name, seeds) in enumerate(found) if seeds]
    log = _is_uneven(series) if log is None else log
    drawing = plot(
        series,
        x_label=f"{x_label} (logarithmic)" if log else x_label,
        y_label=y_label,
        title=title or f"{y_label} over {x_label}, by optimizer",
        description="; ".join(_told(s, x_label, percent) for s in series),
        y_range=y_range,
        x_start=None if log else 0.0,
        log=log,
        percent=percent,
        width=width,
        height=max(230, width * 0.42),
        whole=True,
    )
    return _with_styles(drawing)


def mean_band(curves: Sequence[Curve]) -> list[tuple[float, float, float]]:
    """Mean and standard deviation of curves whose values stay until their next point.

    Args:
        curves: One or more curves with at least one point each.

    Returns:
        ``(x, mean, sd)`` at every x of a curve. Before its first point a curve counts with its
        first value, after its last one with its last; with a single curve ``sd`` is 0.
    """
    found = []
    for x in sorted({x for curve in curves for x, _ in curve}):
        values = [_value(curve, x) for curve in curves]
        sd = statistics.stdev(values) if len(values) > 1 else 0.0
        found.append((x, statistics.fmean(values), sd))
    return found


def _value(curve: Curve, x: float) -> float:
    return curve[max(0, bisect_right(curve, x, key=lambda point: point[0]) - 1)][1]


def _series(name: str, number: int, seeds: Sequence[Curve], top: float) -> Series:
    found = mean_band(seeds)
    points = [Point(x, mean, title=f"{name}: {mean:.3g} after {x:g}") for x, mean, _ in found]
    changes = {n for n in range(1, len(found)) if found[n][1] != found[n - 1][1]}
    band = [(max(0.0, m - sd), min(top, m + sd)) for _, m, sd in found] if len(seeds) > 1 else []
    return Series(
        points,
        name=name,
        style=number,
        stairs=True,
        marked=frozenset(changes | {0, len(found) - 1}),
        band=band,
    )


def _is_uneven(series: Sequence[Series]) -> bool:
    """True where a linear axis would squeeze some lines into a corner."""
    ends = [s.points[-1].x for s in series]
    starts = [s.points[0].x for s in series]
    return bool(ends) and min(starts) > 0 and max(ends) > UNEVEN * min(ends)


def _told(series: Series, x_label: str, percent: bool) -> str:
    first, last = series.points[0], series.points[-1]
    shown = [f"{p.y:.0%}" if percent else f"{p.y:.3g}" for p in (first, last)]
    return f"{series.name}: from {shown[0]} to {shown[1]} in {last.x:g} {x_label}"


def _with_styles(drawing: Markup) -> Markup:
    opening, content = drawing.split(">", 1)
    styles = el("style", Markup(plot_styles()))
    return Markup(f'{opening} xmlns="http://www.w3.org/2000/svg">{styles}{content}')
