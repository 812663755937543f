"""Axes of a plot: scales, round tick values, their labels."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vaso.report.markup import Markup, el

LETTER = 7.2
TOP, RIGHT, BOTTOM = 12, 18, 44


@dataclass(frozen=True, slots=True)
class Scale:
    """Maps values to pixels, evenly or by their logarithm."""

    low: float
    high: float
    start: float
    end: float
    log: bool = False

    def __call__(self, value: float) -> float:
        """The pixel of a value."""
        low, high, at = (math.log10(v) if self.log else v for v in (self.low, self.high, value))
        share = (at - low) / ((high - low) or 1.0)
        return round(self.start + share * (self.end - self.start), 1)


@dataclass(frozen=True, slots=True)
class Axes:
    """The frame of a plot.

    Attributes:
        x: Scale of the x axis.
        y: Scale of the y axis.
        markup: Grid lines, tick labels and names.
    """

    x: Scale
    y: Scale
    markup: list[Markup]


def make_axes(
    x_range: tuple[float, float],
    y_range: tuple[float, float],
    *,
    size: tuple[float, float],
    names: tuple[str, str],
    percent: bool = False,
    whole: bool = False,
    log: bool = False,
) -> Axes:
    """Lay out the axes.

    Args:
        x_range: Lowest and highest x.
        y_range: Lowest and highest y.
        size: Width and height in pixels, with labels.
        names: What is on the x axis and on the y axis.
        percent: Label the y axis in per cent.
        whole: Only whole numbers on the x axis.
        log: A logarithmic x axis, for values above 0.
    """
    width, height = size
    y = Scale(*y_range, height - BOTTOM, TOP)
    labels = [(t, f"{t * 100:.0f}%" if percent else f"{t:.6g}") for t in ticks(y, 4)]
    left = 30 + max(len(text) for _, text in labels) * LETTER
    x = Scale(*x_range, left, width - RIGHT, log)
    parts = [_grid_line(y(t), left, width - RIGHT) for t, _ in labels]
    parts += [_text(text, left - 8, y(t) + 4, "end") for t, text in labels]
    parts += _x_labels(x, height - BOTTOM + 18, whole)
    parts.append(_text(names[0], (left + width - RIGHT) / 2, height - 6, "middle"))
    side = f"translate(13 {(TOP + height - BOTTOM) / 2:g}) rotate(-90)"
    parts.append(el("text", names[1], transform=side, text_anchor="middle", cls="soft"))
    return Axes(x, y, parts)


def ticks(scale: Scale, count: int) -> list[float]:
    """About ``count`` round values along a scale."""
    if scale.log:
        powers = range(math.floor(math.log10(scale.low)), math.ceil(math.log10(scale.high)) + 1)
        found = [m * 10.0**power for power in powers for m in (1, 2, 5)]
        within = [t for t in found if scale.low <= t <= scale.high]
        return within if len(within) <= count else [t for t in within if t in found[::3]]
    step = _nice((scale.high - scale.low) / count)
    first = math.ceil(scale.low / step - 1e-9)
    values = [(first + i) * step for i in range(2 * count + 2)]
    return [t for t in values if t <= scale.high + step * 1e-6]


def _nice(step: float) -> float:
    """The next of 1, 2, 2.5, 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(m * power for m in (1, 2, 2.5, 5, 10) if m * power >= step * (1 - 1e-9))


def _x_labels(x: Scale, y: float, whole: bool) -> list[Markup]:
    count = max(2, int((x.end - x.start) / (40 if x.log else 70)))
    chosen = [t for t in ticks(x, count) if not whole or t == int(t)]
    return [_text(f"{t:.6g}", x(t), y, "middle") for t in chosen]


def _grid_line(y: float, start: float, end: float) -> Markup:
    return el("line", x1=start, x2=end, y1=y, y2=y, cls="axis")


def _text(text: str, x: float, y: float, anchor: str) -> Markup:
    return el("text", text, x=round(x, 1), y=round(y, 1), text_anchor=anchor, cls="soft")
