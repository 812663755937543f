"""What clauses ask of the run of a ground robot: where it was, whether it moved."""

from __future__ import annotations

import math
from collections.abc import Sequence

from vaso.simulation.geometry import Point
from vaso.simulation.names import kind_of
from vaso.simulation.scene import Scene
from vaso.simulation.truth import GroundMoment, GroundTruth

__all__ = ["first_missed", "gap_to", "is_still", "local", "local_point", "moving", "places_of"]

STILL = 0.02
"""Speeds below this (m/s, rad/s) are standing still."""


def moving(run: GroundTruth) -> Sequence[GroundMoment]:
    """The moments in which the plan was in command."""
    return [m for m in run.moments if not m.after_stop] or run.moments


def is_still(moment: GroundMoment) -> bool:
    """Whether the robot stands still."""
    return abs(moment.linear) < STILL and abs(moment.angular) < STILL


def local(run: GroundTruth, moment: GroundMoment) -> Point:
    """A position as metres ahead of the start and to the left of it."""
    return local_point(run, moment.at)


def first_missed(path: Sequence[Point], points: Sequence[Point], within: float) -> int | None:
    """Which point a path does not pass in its turn, the first one; None if it passes all."""
    position = 0
    for number, point in enumerate(points):
        while position < len(path) and math.dist(path[position], point) > within:
            position += 1
        if position == len(path):
            return number
    return None


def places_of(scene: Scene, what: str) -> list[Point]:
    """Where the things of a name or kind are in a scene."""
    kind = kind_of(what)
    named = [
        *((o.kind, o.at) for o in scene.objects),
        *((f.kind, f.at) for f in scene.furniture),
        *((p.name, p.at) for p in scene.places),
        *((d.name, d.at) for d in scene.doorways),
    ]
    found = [at for name, at in named if what == name or kind == kind_of(name)]
    if not found and kind in ("obstacle", "furniture"):
        found = [f.at for f in scene.furniture]
    other = scene.find(what)
    return found or ([other] if other else [])


def local_point(run: GroundTruth, at: Point) -> Point:
    """A point of the scene as metres ahead of the start and to the left of it."""
    start = run.moments[0]
    dx, dy = at[0] - start.x, at[1] - start.y
    cos, sin = math.cos(start.heading), math.sin(start.heading)
    return (dx * cos + dy * sin, dy * cos - dx * sin)


def gap_to(run: GroundTruth, moment: GroundMoment, what: str) -> float:
    """Distance to the nearest thing of a name; people count where they are at that moment."""
    spots = [p for p in moment.people if p is not None] if kind_of(what) == "person" else []
    spots += places_of(run.scene, what)
    return min((math.dist(moment.at, p) for p in spots), default=math.inf)
