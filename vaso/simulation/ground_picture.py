"""A drive as a picture: the map with what the robot did where, and a time line below it."""

from __future__ import annotations

import math
from typing import Any

from vaso.execution import RunLog
from vaso.simulation.activity import Span, activities, sightings
from vaso.simulation.colours import ACTIVITY, INK, PEOPLE, SEEN, SOFT, SOLID
from vaso.simulation.geometry import Point, rectangle
from vaso.simulation.jackal import FOOTPRINT
from vaso.simulation.scene import Scene
from vaso.simulation.truth import GroundMoment, GroundTruth

__all__ = ["circle", "draw_ground", "draw_scene", "view_of"]

_ROW = 0.28
_LONG_STAND = 1.0
_NAMES = {"person": "people"}


def draw_ground(figure: Any, truth: GroundTruth, log: RunLog | None) -> None:
    """Fill an empty matplotlib figure.

    Args:
        figure: The figure; its size is changed to fit.
        truth: The run.
        log: Its log, for what the shield did.
    """
    seen = sightings(truth)
    (left, right), (low, high) = view_of(truth)
    rows = _ROW * (1 + len(seen)) + 0.6
    width = 9.0
    height = min(8.0, max(3.0, width * (high - low) / (right - left)))
    figure.set_size_inches(width, height + rows + 0.7)
    chart, line = figure.subplots(2, 1, height_ratios=[height, rows])
    draw_scene(chart, truth)
    _draw_people(chart, truth)
    _draw_path(chart, truth)
    _draw_robot(chart, truth.moments[0], "none")
    _draw_robot(chart, truth.moments[-1], "#ffffff")
    _draw_events(chart, truth, log)
    _draw_time(line, truth, seen)
    if chart.get_legend_handles_labels()[0]:
        figure.legend(loc="outside lower center", ncols=8, frameon=False, fontsize=8.5)


def view_of(truth: GroundTruth) -> tuple[Point, Point]:
    """The part of the plane that a picture shows: (left, right), (bottom, top) in metres."""
    scene = truth.scene
    points = [*truth.path, *(p for s in scene.wall_segments for p in s)]
    points += [p for f in scene.furniture for p in f.polygon]
    points += [o.at for o in scene.objects]
    points += [p.at for p in scene.places] + [d.at for d in scene.doorways]
    some = truth.moments[:: max(1, len(truth.moments) // 200)]
    points += [p for m in some for p in m.people if p]
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    return (min(xs) - 0.6, max(xs) + 0.6), (min(ys) - 0.6, max(ys) + 0.6)


def draw_scene(axes: Any, truth: GroundTruth) -> None:
    """Draw walls and things, with their names, on matplotlib axes."""
    scene = truth.scene
    xs, ys = view_of(truth)
    axes.set(xlim=xs, ylim=ys, aspect="equal", xlabel="x in metres", ylabel="y in metres")
    axes.xaxis.label.set(size=9, color=SOFT)
    axes.yaxis.label.set(size=9, color=SOFT)
    axes.tick_params(colors=SOFT, labelsize=8)
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.grid(color="#e8ecf1", linewidth=0.6)
    axes.set_axisbelow(True)
    for wall in scene.wall_segments:
        axes.plot(*zip(*wall, strict=True), color=INK, linewidth=2.5, solid_capstyle="round")
    _draw_things(axes, scene)


def _draw_things(axes: Any, scene: Scene) -> None:
    for room in scene.rooms:
        spot = (min(p[0] for p in room.polygon) + 0.15, max(p[1] for p in room.polygon) - 0.12)
        _name(axes, room.name, spot, color=SOFT, size=9, style="italic", ha="left")
    for door in scene.doorways:
        axes.plot(*zip(*door.ends, strict=True), color=SOFT, linewidth=1, linestyle=(0, (2, 2)))
        _name(axes, door.name, door.at, color=SOFT)
    for place in scene.places:
        axes.plot(*place.at, marker="+", color=SOFT, markersize=8)
        _name(axes, place.name, place.at, color=SOFT)
    for piece in scene.furniture:
        axes.fill(
            *zip(*piece.polygon, strict=True), facecolor=SOLID["furniture"], edgecolor=SOLID["edge"]
        )
        _name(axes, piece.kind, piece.at, middle=True)
    for item in scene.objects:
        axes.fill(*circle(item.at, item.radius), facecolor=SOLID["object"], edgecolor=INK, lw=0.6)
        _name(axes, item.kind, (item.at[0], item.at[1] - item.radius))


def _name(axes: Any, name: str, at: Point, *, middle: bool = False, **style: Any) -> None:
    if not name:
        return
    options = {"ha": "center", "va": "center" if middle else "top", "size": 8, "color": INK}
    axes.annotate(
        name,
        at,
        xytext=(0, 0 if middle else -3),
        textcoords="offset points",
        bbox={"facecolor": "white", "alpha": 0.65, "edgecolor": "none", "pad": 0.6},
        zorder=3,
        **{**options, **style},
    )


def _draw_people(axes: Any, truth: GroundTruth) -> None:
    for number, person in enumerate(truth.scene.people):
        path = [m.people[number] for m in truth.moments if m.people and m.people[number]]
        spots = [p for p in path if p is not None]
        if not spots:
            continue
        label = "people's paths" if number == 0 else None
        axes.plot(*zip(*spots, strict=True), color=PEOPLE, lw=1.2, ls=(0, (1, 1.6)), label=label)
        axes.fill(*circle(spots[-1], 0.25), facecolor=PEOPLE, alpha=0.35, edgecolor=PEOPLE)
        _name(axes, person.name, spots[-1], middle=True, color="#8a3c00")


def _draw_path(axes: Any, truth: GroundTruth) -> None:
    told: set[str] = set()
    for span in activities(truth):
        moments = truth.moments[span.first : span.last + 1]
        label = None if span.what in told else span.what
        colour = ACTIVITY[span.what]
        if span.what in ("drives", "backs up"):
            xs, ys = zip(*(m.at for m in moments), strict=True)
            axes.plot(xs, ys, color=colour, linewidth=2.4, label=label, zorder=4)
        elif span.what == "touches":
            continue  # marked as an event
        elif span.what != "stands" or _duration(truth, span) >= _LONG_STAND:
            size = 5 if span.what != "stands" else 9
            style = {"marker": "o", "linestyle": "none", "markersize": size, "zorder": 5}
            axes.plot(*moments[-1].at, color=colour, alpha=0.9, label=label, **style)
        else:
            continue
        told.add(span.what)


def _draw_robot(axes: Any, moment: GroundMoment, fill: str) -> None:
    corners = rectangle(moment.at, FOOTPRINT, moment.heading)
    xs, ys = zip(*corners, strict=True)
    axes.fill(xs, ys, facecolor=fill, edgecolor=INK, linewidth=1.2, zorder=6)
    nose = (0.42 * math.cos(moment.heading), 0.42 * math.sin(moment.heading))
    axes.annotate(
        "",
        (moment.x + nose[0], moment.y + nose[1]),
        moment.at,
        arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 1.2, "shrinkA": 0, "shrinkB": 0},
        zorder=7,
    )
    word = "start" if moment.step == 0 else "end"
    spot = (moment.x, min(ys))
    _name(axes, word, spot, weight="bold")


def _draw_events(axes: Any, truth: GroundTruth, log: RunLog | None) -> None:
    if truth.contacts:
        xs, ys = zip(*(m.at for m in truth.contacts), strict=True)
        style = {"marker": "x", "linestyle": "none", "markersize": 9, "mew": 2.2, "zorder": 8}
        axes.plot(xs, ys, color=ACTIVITY["touches"], label="touches", **style)
    steps = {r.step for r in log.records if r.intervention} if log else set()
    spots = [m.at for m in truth.moments if m.step in steps]
    if spots:
        style = {"marker": "D", "linestyle": "none", "markersize": 6, "zorder": 8, "mec": "white"}
        axes.plot(*zip(*spots, strict=True), color="#880038", label="shield", **style)


def _draw_time(axes: Any, truth: GroundTruth, seen: dict[str, tuple[Span, ...]]) -> None:
    rows = ["robot", *(_NAMES.get(kind, kind) for kind in seen)]
    axes.set(xlim=(0, truth.moments[-1].time or 1), ylim=(len(rows) - 0.4, -0.6))
    axes.set_xlabel("time in seconds", size=9, color=SOFT)
    axes.set_yticks(range(len(rows)), [f"{r} reported" if i else r for i, r in enumerate(rows)])
    axes.tick_params(labelsize=8, colors=SOFT, length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    for span in activities(truth):
        _bar(axes, truth, span, 0, ACTIVITY[span.what])
    for row, (kind, reported) in enumerate(seen.items(), 1):
        axes.axhline(row, color="#e8ecf1", linewidth=6, zorder=0)
        for span in reported:
            _bar(axes, truth, span, row, SEEN.get(kind, SOLID["object"]))


def _bar(axes: Any, truth: GroundTruth, span: Span, row: int, colour: str) -> None:
    start, end = truth.moments[span.first].time, truth.moments[span.last].time
    axes.barh(row, end - start, left=start, height=0.6, color=colour, linewidth=0)


def _duration(truth: GroundTruth, span: Span) -> float:
    return truth.moments[span.last].time - truth.moments[span.first].time


def circle(at: Point, radius: float) -> tuple[list[float], list[float]]:
    """A circle as a polygon: its x and its y."""
    angles = [math.tau * i / 24 for i in range(24)]
    return (
        [at[0] + radius * math.cos(a) for a in angles],
        [at[1] + radius * math.sin(a) for a in angles],
    )
