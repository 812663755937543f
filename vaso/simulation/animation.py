"""A run as an animated GIF (matplotlib and Pillow, extra ``plots``)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from vaso.execution import Record, RunLog
from vaso.simulation.activity import activities
from vaso.simulation.colours import ACTIVITY, INK, PEOPLE, SOFT, SOLID
from vaso.simulation.flight_picture import draw_limit, plain
from vaso.simulation.flight_picture import view_of as flight_view
from vaso.simulation.geometry import Point, rectangle
from vaso.simulation.ground_picture import circle, draw_scene, view_of
from vaso.simulation.jackal import FOOTPRINT
from vaso.simulation.truth import FlightTruth, GroundMoment, GroundTruth

__all__ = ["save_gif"]

FRAMES_A_SECOND = 10
SECONDS = 10.0
_LAST = 1500
"""For how many milliseconds the last frame stays."""

Show = Callable[[int], Sequence[Any]]
"""Brings what moves into the state of a moment; returns it, in the order of drawing."""


def save_gif(
    path: Path,
    truth: GroundTruth | FlightTruth,
    log: RunLog | None,
    limits: Mapping[str, float],
    *,
    speed: float | None = None,
) -> None:
    """Write an animation.

    Args:
        path: The file.
        truth: The run.
        log: Its log, for commands and the shield.
        limits: What rules allow at most, by quantity.
        speed: How many times faster than the run it is; by default it takes ten seconds.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(facecolor="white", dpi=80, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    records = {r.step: r for r in log.records} if log else {}
    if isinstance(truth, GroundTruth):
        show = _ground(figure, truth, records)
    else:
        show = _flight(figure, truth, records, limits)
    images = list(_images(canvas, truth, show, speed))
    times = [1000 // FRAMES_A_SECOND] * (len(images) - 1) + [_LAST]
    images[0].save(path, save_all=True, append_images=images[1:], duration=times, loop=0)


def _images(
    canvas: Any, truth: GroundTruth | FlightTruth, show: Show, speed: float | None
) -> Iterator[Any]:
    """The frames. What does not move is drawn once; what moves, on top of it."""
    from PIL import Image

    end = truth.moments[-1].time
    step = (speed or max(1.0, end / SECONDS)) / FRAMES_A_SECOND
    canvas.draw()
    canvas.figure.set_layout_engine("none")
    still = canvas.copy_from_bbox(canvas.figure.bbox)
    for frame in range(max(1, math.ceil(end / step)) + 1):
        canvas.restore_region(still)
        for artist in show(min(len(truth.moments) - 1, round(frame * step / truth.dt))):
            artist.axes.draw_artist(artist)
        shot = Image.frombuffer("RGBA", canvas.get_width_height(), canvas.buffer_rgba())
        yield shot.convert("RGB").quantize(colors=96, dither=Image.Dither.NONE)


def _ground(figure: Any, truth: GroundTruth, records: Mapping[int, Record]) -> Show:
    (left, right), (low, high) = view_of(truth)
    figure.set_size_inches(8.0, min(7.0, max(3.0, 8.0 * (high - low) / (right - left))) + 0.7)
    axes = figure.subplots()
    draw_scene(axes, truth)
    line = _line(axes)
    driven, colours = _driven(truth)
    path = _collection(axes, colours)
    view = axes.fill([0], [0], color=SOLID["view"], alpha=0.10, lw=0, animated=True)[0]
    style = {"edgecolor": INK, "linewidth": 1.4, "zorder": 6, "animated": True}
    body = axes.fill([0], [0], facecolor="#ffffff", **style)[0]
    (nose,) = axes.plot([], [], color=INK, linewidth=2, zorder=7, animated=True)
    people = [
        axes.fill([0], [0], color=PEOPLE, alpha=0.55, zorder=5, animated=True)[0]
        for _ in truth.scene.people
    ]

    def show(number: int) -> Sequence[Any]:
        here = truth.moments[number]
        path.set_segments([part for n, part in driven if n <= number])
        view.set_xy(_view(truth, here))
        body.set_xy(list(rectangle(here.at, FOOTPRINT, here.heading)))
        body.set_facecolor(ACTIVITY["touches"] if here.contact else "#ffffff")
        tip = (here.x + 0.4 * math.cos(here.heading), here.y + 0.4 * math.sin(here.heading))
        nose.set_data(*zip(here.at, tip, strict=True))
        for shape, spot in zip(people, here.people, strict=False):
            shape.set_visible(spot is not None)
            if spot is not None:
                shape.set_xy(list(zip(*circle(spot, 0.25), strict=True)))
        seen = [kind for kind, is_seen in here.reported.items() if is_seen]
        _tell(line, here.time, records.get(here.step), f"sees: {', '.join(seen) or 'nothing'}")
        return [view, path, *people, body, nose, line]

    return show


def _driven(truth: GroundTruth) -> tuple[list[tuple[int, list[Point]]], list[str]]:
    """Every piece of the path with the number of its last moment, and their colours."""
    pieces, colours = [], []
    for span in activities(truth):
        for number in range(span.first, span.last):
            a, b = truth.moments[number].at, truth.moments[number + 1].at
            if a != b:
                pieces.append((number + 1, [a, b]))
                colours.append(ACTIVITY[span.what])
    return pieces, colours


def _collection(axes: Any, colours: Sequence[str]) -> Any:
    from matplotlib.collections import LineCollection

    style: Any = {"linewidths": 2.2, "capstyle": "round", "zorder": 4, "animated": True}
    return axes.add_collection(LineCollection([], colors=colours or [INK], **style))


def _view(truth: GroundTruth, here: GroundMoment) -> list[Point]:
    """The camera's field of view, walls not regarded."""
    half, reach = math.radians(truth.camera.field_of_view) / 2, truth.camera.distance
    angles = (here.heading + half * (i / 8 - 1) for i in range(17))
    rim = [(here.x + reach * math.cos(a), here.y + reach * math.sin(a)) for a in angles]
    return [here.at, *rim]


def _flight(
    figure: Any, truth: FlightTruth, records: Mapping[int, Record], limits: Mapping[str, float]
) -> Show:
    figure.set_size_inches(9.0, 4.4)
    above, height = figure.subplots(1, 2)
    xs, ys = flight_view(truth)
    for axes in (above, height):
        plain(axes)
    above.set(xlim=xs, ylim=ys, aspect="equal", xlabel="metres east", ylabel="metres north")
    height.set(xlabel="time in seconds", ylabel="altitude in metres")
    height.set_xlim(0, truth.moments[-1].time or 1)
    planned = [m for m in truth.moments if not m.after_stop]
    norths, easts, tops = zip(*(m.reference for m in planned), strict=True)
    above.plot(easts, norths, color=SOFT, lw=1.1, ls="--")
    height.plot([m.time for m in planned], tops, color=SOFT, lw=1.1, ls="--")
    draw_limit(height, limits.get("altitude"), "m", max(truth.highest, *tops, 1.0))
    line = _line(above)
    style = {"color": ACTIVITY["flies"], "lw": 2.2, "animated": True}
    (path,), (climb,) = above.plot([], [], **style), height.plot([], [], **style)
    (spot,) = above.plot([], [], marker="o", color=INK, mfc="white", ms=9, mew=2, animated=True)

    def show(number: int) -> Sequence[Any]:
        here = truth.moments[number]
        flown = [p for p in truth.track if p[0] <= here.time + 1e-6]
        path.set_data([p[2] for p in flown], [p[1] for p in flown])
        spot.set_data([here.east], [here.north])
        climb.set_data([p[0] for p in flown], [p[3] for p in flown])
        _tell(line, here.time, records.get(here.step), f"{here.speed:.1f} m/s")
        return [path, spot, climb, line]

    return show


def _line(axes: Any) -> Any:
    """The line of text above a frame."""
    axes.set_title(" ", loc="left", fontsize=10)  # room for it
    style = {"fontsize": 10, "color": INK, "family": "monospace", "animated": True}
    return axes.annotate(
        "", (0, 1), xycoords="axes fraction", xytext=(0, 6), textcoords="offset points", **style
    )


def _tell(line: Any, time: float, record: Record | None, told: str) -> None:
    parts = [f"{time:5.1f} s"]
    if record is not None and record.api:
        parts.append(record.api)
    parts.append(told)
    if record is not None and record.intervention is not None:
        parts.append("SHIELD")
    line.set_text("   ".join(parts))
