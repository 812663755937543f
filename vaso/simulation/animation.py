"""A run as an animated GIF (matplotlib and Pillow, extra ``plots``)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from vaso.execution import Record, RunLog
from vaso.simulation.activity import activities
from vaso.simulation.colours import ACTIVITY, INK, PEOPLE, SOFT
from vaso.simulation.flight_picture import draw_limit, plain
from vaso.simulation.flight_picture import view_of as flight_view
from vaso.simulation.geometry import rectangle
from vaso.simulation.ground_picture import circle, draw_scene, view_of
from vaso.simulation.jackal import FOOTPRINT
from vaso.simulation.truth import FlightTruth, GroundTruth

__all__ = ["save_gif"]

FRAMES_A_SECOND = 10
SECONDS = 10.0
_LAST = 1500
"""For how many milliseconds the last frame stays."""

Show = Callable[[int], None]


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
    from PIL import Image

    end = truth.moments[-1].time
    step = (speed or max(1.0, end / SECONDS)) / FRAMES_A_SECOND
    count = max(1, math.ceil(end / step))
    for frame in range(count + 1):
        show(min(len(truth.moments) - 1, round(frame * step / truth.dt)))
        canvas.draw()
        shot = Image.frombuffer("RGBA", canvas.get_width_height(), canvas.buffer_rgba())
        yield shot.convert("RGB").quantize(colors=96, dither=Image.Dither.NONE)


def _ground(figure: Any, truth: GroundTruth, records: Mapping[int, Record]) -> Show:
    (left, right), (low, high) = view_of(truth)
    figure.set_size_inches(8.0, min(7.0, max(3.0, 8.0 * (high - low) / (right - left))) + 0.7)
    axes = figure.subplots()
    draw_scene(axes, truth)
    did = {n: s.what for s in activities(truth) for n in range(s.first + 1, s.last + 1)}
    (body,) = axes.fill([0], [0], facecolor="#ffffff", edgecolor=INK, linewidth=1.4, zorder=6)
    (nose,) = axes.plot([], [], color=INK, linewidth=2, zorder=7)
    people = [
        axes.fill([0], [0], facecolor=PEOPLE, edgecolor=PEOPLE, alpha=0.55, zorder=5)[0]
        for _ in truth.scene.people
    ]
    drawn = 0

    def show(number: int) -> None:
        nonlocal drawn
        for n in range(drawn, number):
            a, b = truth.moments[n], truth.moments[n + 1]
            if a.at != b.at:
                style = {"color": ACTIVITY[did.get(n + 1, "drives")], "lw": 2.2, "zorder": 4}
                axes.plot([a.x, b.x], [a.y, b.y], **style)
        drawn = max(drawn, number)
        here = truth.moments[number]
        body.set_xy(list(rectangle(here.at, FOOTPRINT, here.heading)))
        body.set_facecolor(ACTIVITY["touches"] if here.contact else "#ffffff")
        tip = (here.x + 0.4 * math.cos(here.heading), here.y + 0.4 * math.sin(here.heading))
        nose.set_data(*zip(here.at, tip, strict=True))
        for shape, spot in zip(people, here.people, strict=False):
            shape.set_visible(spot is not None)
            if spot is not None:
                shape.set_xy(list(zip(*circle(spot, 0.25), strict=True)))
        seen = [kind for kind, is_seen in here.reported.items() if is_seen]
        _tell(axes, here.time, records.get(here.step), f"sees: {', '.join(seen) or 'nothing'}")

    return show


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
    (path,) = above.plot([], [], color="#2155c0", lw=2.2)
    (spot,) = above.plot([], [], marker="o", color=INK, mfc="white", ms=9, mew=2)
    (climb,) = height.plot([], [], color="#2155c0", lw=2.2)

    def show(number: int) -> None:
        here = truth.moments[number]
        flown = [p for p in truth.track if p[0] <= here.time + 1e-6]
        path.set_data([p[2] for p in flown], [p[1] for p in flown])
        spot.set_data([here.east], [here.north])
        climb.set_data([p[0] for p in flown], [p[3] for p in flown])
        _tell(above, here.time, records.get(here.step), f"{here.speed:.1f} m/s")

    return show


def _tell(axes: Any, time: float, record: Record | None, told: str) -> None:
    """The line above a frame."""
    parts = [f"{time:5.1f} s"]
    if record is not None and record.api:
        parts.append(record.api)
    parts.append(told)
    if record is not None and record.intervention is not None:
        parts.append("SHIELD")
    axes.set_title("   ".join(parts), fontsize=10, color=INK, loc="left", family="monospace")
