"""A run as a web page of its own: everything in one file, drawn on a canvas by a short script."""

from __future__ import annotations

import html
import json
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from vaso.execution import Record, RunLog
from vaso.report.palette import variables
from vaso.simulation import flight_picture, ground_picture
from vaso.simulation.activity import Span, activities
from vaso.simulation.colours import ACTIVITY, PEOPLE, SOLID
from vaso.simulation.jackal import FOOTPRINT
from vaso.simulation.truth import FlightTruth, GroundTruth

__all__ = ["page"]


def page(
    truth: GroundTruth | FlightTruth,
    log: RunLog | None,
    limits: Mapping[str, float],
    title: str,
) -> str:
    """The page's text.

    Args:
        truth: The run.
        log: Its log, for commands, plan lines and the shield.
        limits: What rules allow at most, by quantity.
        title: Its heading.
    """
    data = _ground(truth) if isinstance(truth, GroundTruth) else _flight(truth, limits)
    records = {r.step: r for r in log.records} if log else {}
    data["states"] = [_state(records.get(m.step)) for m in truth.moments]
    data["colours"] = {**ACTIVITY, **SOLID, "people": PEOPLE}
    data["did"] = _by_moment(activities(truth), len(truth.moments))
    folder = files("vaso.simulation")
    text = (folder / "page.html").read_text(encoding="utf-8")
    for name, part in (
        ("STYLE", variables("body")),
        ("TITLE", html.escape(title or "run")),
        ("SCRIPT", (folder / "page.js").read_text(encoding="utf-8")),
        ("DATA", json.dumps(data, ensure_ascii=False, allow_nan=False).replace("</", "<\\/")),
    ):
        text = text.replace(f"%{name}%", part)
    return text


def _ground(truth: GroundTruth) -> dict[str, Any]:
    scene = truth.scene
    return {
        "kind": "ground",
        "view": ground_picture.view_of(truth),
        "dt": truth.dt,
        "footprint": FOOTPRINT,
        "camera": [truth.camera.field_of_view, truth.camera.distance],
        "walls": scene.wall_segments,
        "rooms": [
            [r.name, min(p[0] for p in r.polygon), max(p[1] for p in r.polygon)]
            for r in scene.rooms
        ],
        "furniture": [[f.kind, f.polygon, f.at] for f in scene.furniture],
        "objects": [[o.kind, o.at, o.radius] for o in scene.objects],
        "places": [[p.name, p.at] for p in scene.places] + [[d.name, d.at] for d in scene.doorways],
        "people": [p.name for p in scene.people],
        "frames": [
            [
                round(m.time, 3),
                round(m.x, 4),
                round(m.y, 4),
                round(m.heading, 4),
                [[round(p[0], 3), round(p[1], 3)] if p else None for p in m.people],
                [kind for kind, seen in m.reported.items() if seen],
                m.contact,
                round(abs(m.linear), 3),
            ]
            for m in truth.moments
        ],
    }


def _flight(truth: FlightTruth, limits: Mapping[str, float]) -> dict[str, Any]:
    return {
        "kind": "flight",
        "view": flight_picture.view_of(truth),
        "dt": truth.dt,
        "highest": max(truth.highest, *(m.reference[2] for m in truth.moments), 1.0),
        "limit": limits.get("altitude"),
        "track": [[round(v, 3) for v in point] for point in truth.track],
        "planned": [
            [m.time, *(round(v, 3) for v in m.reference)] for m in truth.moments if not m.after_stop
        ],
        "frames": [
            [m.time, round(m.east, 4), round(m.north, 4), round(m.altitude, 4), round(m.speed, 3)]
            for m in truth.moments
        ],
    }


def _state(record: Record | None) -> list[Any]:
    """The plan's call, its line, and what the shield did instead."""
    if record is None:
        return ["", None, ""]
    changed = record.intervention
    told = f"{changed.wanted} replaced: {changed.reason}" if changed else ""
    return [record.api or record.note, record.line, told]


def _by_moment(done: tuple[Span, ...], count: int) -> list[str]:
    found = [""] * count
    for span in done:
        for number in range(span.first + 1, span.last + 1):
            found[number] = span.what
    return found
