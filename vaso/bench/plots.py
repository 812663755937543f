"""Measurements as pictures (extra ``plots``)."""

from __future__ import annotations

import importlib
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from vaso.bench.many import Pass
from vaso.bench.measure import Point
from vaso.bench.scaling import families
from vaso.bench.suite import Suite
from vaso.errors import MissingDependencyError
from vaso.report.palette import SERIES_LIGHT

__all__ = ["draw"]

MARKS, DASHES = "os^D", ("-", (0, (6, 2)), (0, (2, 2)), "-.")
SECONDS = "time in seconds"
GOAL = 2000
"""Transitions a second that exploration is meant to reach."""


def draw(suite: Suite, folder: Path) -> list[Path]:
    """Write the plots as SVG files, and return their paths.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    try:
        figure = importlib.import_module("matplotlib.figure").Figure
    except ModuleNotFoundError as error:
        raise MissingDependencyError("matplotlib", "plots") from error
    drawn = {
        "scaling.svg": _scaling(figure, suite),
        "satisfiability.svg": _satisfiability(figure, suite),
        "exploration.svg": _exploration(figure, suite),
        "many.svg": _many(figure, suite),
    }
    paths = []
    for name, picture in drawn.items():
        paths.append(folder / name)
        picture.savefig(paths[-1], metadata={"Date": None})
    return paths


def _scaling(figure: Any, suite: Suite) -> Any:
    """A panel for each number that grows; both axes logarithmic, all panels on one scale."""
    picture = figure(figsize=(10.5, 3.6), layout="constrained")
    panels = picture.subplots(1, len(suite.scaling), sharey=True)
    units = {family.name: family.unit for family in families()}
    for axes, (name, points) in zip(panels, suite.scaling.items(), strict=True):
        _lines(axes, points, suite.limit)
        axes.set(xlabel=units[name], xscale="log", yscale="log")
        _plain_numbers(axes.yaxis)
        _plain_ticks(axes.xaxis, sorted({p.x for p in points}))
        axes.grid(alpha=0.25)
    panels[0].set_ylabel(SECONDS)
    panels[0].legend(frameon=False, fontsize=9)
    picture.suptitle(f"Exploring a plan and checking its rules\n{suite.machine}", fontsize=10)
    return picture


def _satisfiability(figure: Any, suite: Suite) -> Any:
    """A panel for rules that can be kept, and one for rules that cannot."""
    picture = figure(figsize=(9, 3.8), layout="constrained")
    kinds = {"satisfiable": "", "in conflict": ", in conflict"}
    panels = picture.subplots(1, len(kinds), sharey=True)
    for axes, (title, ending) in zip(panels, kinds.items(), strict=True):
        chosen = [p for p in suite.satisfiability if p.what.endswith(ending or "propositions")]
        places = {what: i for i, what in enumerate(dict.fromkeys(p.what for p in chosen))}
        moved = [Point(p.series, places[p.what], p.seconds) for p in chosen]
        _lines(axes, moved, suite.limit)
        axes.set(yscale="log", title=f"Sets of rules, {title}")
        _plain_numbers(axes.yaxis)
        labels = ["\n".join(re.findall(r"\d+", what)) for what in places]
        axes.set_xticks(list(places.values()), labels)
        axes.set_xlabel("rules (above), propositions (below)")
        axes.grid(alpha=0.25)
    panels[0].set_ylabel(SECONDS)
    panels[0].legend(frameon=False)
    return picture


def _exploration(figure: Any, suite: Suite) -> Any:
    rates = sorted(suite.exploration, key=lambda rate: rate.transitions)
    picture = figure(figsize=(7.2, 4.2), layout="constrained")
    axes = picture.subplots()
    axes.plot(
        [r.transitions for r in rates],
        [r.per_second for r in rates],
        "o",
        color=SERIES_LIGHT[0],
    )
    goal = {"color": SERIES_LIGHT[1], "linestyle": DASHES[1], "linewidth": 1}
    axes.axhline(GOAL, **goal, label=f"{GOAL:,} a second")
    axes.legend(frameon=False)
    axes.set(
        xscale="log",
        xlabel="transitions of the plan",
        ylabel="transitions per second, one core",
        title="Exploration, one mark a plan",
    )
    axes.set_ylim(bottom=0)
    _plain_numbers(axes.xaxis)
    axes.grid(alpha=0.25)
    return picture


def _many(figure: Any, suite: Suite) -> Any:
    picture = figure(figsize=(7.2, 3.8), layout="constrained")
    axes = picture.subplots()
    for number, found in enumerate(suite.many):
        done = list(range(1, len(found.finished) + 1))
        axes.plot(
            found.finished,
            done,
            color=SERIES_LIGHT[number],
            linestyle=DASHES[number],
            label=_pass_label(found),
        )
    axes.set(xscale="log", xlabel=SECONDS, ylabel="plans done", title="Many plans")
    _plain_numbers(axes.xaxis)
    axes.grid(alpha=0.25)
    axes.legend(frameon=False)
    return picture


def _pass_label(found: Pass) -> str:
    told = f"{found.seconds:.0f} s" if found.seconds >= 10 else f"{found.seconds:.2f} s"
    how = "from the memo" if found.known else f"cold, {found.workers} workers"
    return f"{how}: {told}"


def _lines(axes: Any, points: Sequence[Point], limit: float) -> None:
    """A line for each series; what took longer than allowed is marked at the limit."""
    for number, series in enumerate(dict.fromkeys(p.series for p in points)):
        colour = SERIES_LIGHT[number]
        known = [(p.x, p.seconds) for p in points if p.series == series and p.seconds is not None]
        late = [p.x for p in points if p.series == series and p.seconds is None]
        style = {"color": colour, "linestyle": DASHES[number], "marker": MARKS[number]}
        axes.plot(*zip(*known, strict=True), **style, markersize=5, label=series) if known else None
        if late:
            told = f"{series}: over {limit:g} s"
            places = [limit] * len(late)
            axes.plot(late, places, "x", color=colour, markersize=8, label=told)


def _plain_numbers(axis: Any) -> None:
    """0.1, 0.2, 0.5, 1 along a logarithmic axis."""
    ticker = importlib.import_module("matplotlib.ticker")
    axis.set_major_formatter(ticker.FuncFormatter(lambda x, _: f"{x:,g}"))
    if axis.get_scale() == "log":
        few = ticker.FuncFormatter(lambda x, _: f"{x:,g}" if f"{x:e}"[0] in "25" else "")
        axis.set_minor_formatter(few)


def _plain_ticks(axis: Any, places: Sequence[float]) -> None:
    ticker = importlib.import_module("matplotlib.ticker")
    axis.set_major_locator(ticker.FixedLocator(places))
    axis.set_major_formatter(ticker.FuncFormatter(lambda x, _: f"{x:g}"))
    axis.set_minor_locator(ticker.NullLocator())
