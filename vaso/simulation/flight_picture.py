"""A flight as a picture: from above, and altitude and speed over time with the rules' limits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from vaso.execution import RunLog
from vaso.simulation.activity import activities
from vaso.simulation.colours import ACTIVITY, INK, SOFT
from vaso.simulation.truth import FlightTruth

__all__ = ["draw_flight", "draw_limit", "plain", "view_of"]

_LIMIT = "#b81f28"


def draw_flight(
    figure: Any, truth: FlightTruth, log: RunLog | None, limits: Mapping[str, float]
) -> None:
    """Fill an empty matplotlib figure.

    Args:
        figure: The figure; its size is changed.
        truth: The flight.
        log: Its log, for what the shield did.
        limits: What rules allow at most: ``altitude`` in m, ``linear_velocity`` in m/s.
    """
    figure.set_size_inches(10.5, 5.2)
    grid = figure.add_gridspec(2, 2, width_ratios=[1.05, 1], height_ratios=[1.25, 1])
    above = figure.add_subplot(grid[:, 0])
    height = figure.add_subplot(grid[0, 1])
    speed = figure.add_subplot(grid[1, 1], sharex=height)
    _draw_above(above, truth, log)
    _draw_height(height, truth, limits.get("altitude"))
    _draw_speed(speed, truth, limits.get("linear_velocity"))
    handles, labels = above.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=8, frameon=False, fontsize=8.5)


def view_of(truth: FlightTruth) -> tuple[tuple[float, float], tuple[float, float]]:
    """The part of the plane that a picture shows: (west, east), (south, north) in metres."""
    points = [*truth.path, *((m.reference[0], m.reference[1]) for m in truth.moments)]
    norths, easts = [p[0] for p in points], [p[1] for p in points]
    half = max(max(norths) - min(norths), max(easts) - min(easts), 2.0) / 2 + 0.6
    east, north = (max(easts) + min(easts)) / 2, (max(norths) + min(norths)) / 2
    return (east - half, east + half), (north - half, north + half)


def _draw_above(axes: Any, truth: FlightTruth, log: RunLog | None) -> None:
    xs, ys = view_of(truth)
    plain(axes)
    axes.set(xlim=xs, ylim=ys, aspect="equal", xlabel="metres east", ylabel="metres north")
    axes.set_title("from above", fontsize=10, color=SOFT)
    planned = [m.reference for m in truth.moments if not m.after_stop]
    axes.plot(
        [p[1] for p in planned], [p[0] for p in planned], color=SOFT, lw=1.2, ls="--",
        label="where the set-points lead",
    )  # fmt: skip
    told: set[str] = set()
    for span in activities(truth):
        start, end = truth.moments[span.first].time, truth.moments[span.last].time
        points = [(e, n) for t, n, e, _ in truth.track if start - 1e-6 <= t <= end + 1e-6]
        if not points:
            continue
        label = None if span.what in told else span.what
        east, north = zip(*points, strict=True)
        axes.plot(east, north, color=ACTIVITY[span.what], lw=2.2, label=label)
        told.add(span.what)
    (_, n0, e0, _), (_, n1, e1, _) = truth.track[0], truth.track[-1]
    axes.plot(e0, n0, marker="o", color=INK, ms=7, mfc="white", ls="none", label="take-off")
    axes.plot(e1, n1, marker="X", color=INK, ms=7, ls="none", label="end")
    _draw_shield(axes, truth, log)
    _draw_wind(axes, truth)


def _draw_shield(axes: Any, truth: FlightTruth, log: RunLog | None) -> None:
    steps = {r.step for r in log.records if r.intervention} if log else set()
    spots = [(m.east, m.north) for m in truth.moments if m.step in steps]
    if spots:
        style = {"marker": "D", "ls": "none", "ms": 6, "mec": "white", "zorder": 8}
        axes.plot(*zip(*spots, strict=True), color="#880038", label="shield", **style)


def _draw_wind(axes: Any, truth: FlightTruth) -> None:
    north, east, _ = truth.scene.wind.mean
    size = (north**2 + east**2) ** 0.5
    if not size and not truth.scene.wind.gusts:
        return
    gusts = truth.scene.wind.gusts
    told = f"wind {size:.1f} m/s" + (f", gusts {gusts:g} m/s" if gusts else "")
    axes.text(0.02, 0.98, told, transform=axes.transAxes, va="top", size=8.5, color=SOFT)
    if size:
        axes.annotate(
            "",
            (0.08 + 0.07 * east / size, 0.85 + 0.07 * north / size),
            (0.08 - 0.04 * east / size, 0.85 - 0.04 * north / size),
            xycoords="axes fraction",
            arrowprops={"arrowstyle": "-|>", "color": SOFT, "lw": 1.5},
        )


def _draw_height(axes: Any, truth: FlightTruth, limit: float | None) -> None:
    plain(axes)
    axes.set_ylabel("altitude in metres")
    axes.tick_params(labelbottom=False)
    times = [m.time for m in truth.moments if not m.after_stop]
    planned = [m.reference[2] for m in truth.moments if not m.after_stop]
    axes.plot(times, planned, color=SOFT, lw=1.2, ls="--")
    axes.plot([p[0] for p in truth.track], [p[3] for p in truth.track], color="#2155c0", lw=2)
    draw_limit(axes, limit, "m", max(truth.highest, *planned, 1.0))
    _shade(axes, truth)


def _draw_speed(axes: Any, truth: FlightTruth, limit: float | None) -> None:
    plain(axes)
    axes.set(ylabel="speed in m/s", xlabel="time in seconds")
    moments = truth.moments
    wanted = [0.0, *(sum(v * v for v in m.setpoint) ** 0.5 for m in moments[1:])]
    axes.step([m.time for m in moments], wanted, where="pre", color=SOFT, lw=1.2, ls="--")
    axes.plot([m.time for m in moments], [m.speed for m in moments], color="#2155c0", lw=2)
    draw_limit(axes, limit, "m/s", max(*(m.speed for m in moments), *wanted, 0.1))
    _shade(axes, truth)


def draw_limit(axes: Any, limit: float | None, unit: str, greatest: float) -> None:
    """Draw a limit of the rules, and leave room for it and for the greatest value."""
    axes.set_ylim(0, 1.12 * max(greatest, limit or 0.0))
    if limit is None:
        return
    axes.axhline(limit, color=_LIMIT, lw=1.3)
    axes.annotate(
        f"limit of the rules: {limit:g} {unit}", (1.0, limit), xycoords=("axes fraction", "data"),
        xytext=(-2, 2), textcoords="offset points", ha="right", va="bottom", size=8, color=_LIMIT,
    )  # fmt: skip


def _shade(axes: Any, truth: FlightTruth) -> None:
    for span in activities(truth):
        start, end = truth.moments[span.first].time, truth.moments[span.last].time
        axes.axvspan(start, end, color=ACTIVITY[span.what], alpha=0.10, linewidth=0)
    axes.set_xlim(0, truth.moments[-1].time or 1)


def plain(axes: Any) -> None:
    """Quiet axes: a light grid, no frame."""
    axes.grid(color="#e8ecf1", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(colors=SOFT, labelsize=8)
    for spine in axes.spines.values():
        spine.set_visible(False)
