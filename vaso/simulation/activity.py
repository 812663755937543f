"""What a robot did, moment by moment, in words that a picture can have a colour for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from vaso.simulation.truth import FlightMoment, FlightTruth, GroundMoment, GroundTruth

__all__ = ["Span", "activities", "sightings", "spans"]


@dataclass(frozen=True)
class Span:
    """A stretch of a run in which one thing was going on.

    Attributes:
        what: What.
        first: The moment at its beginning.
        last: The moment at its end; the next span begins there.
    """

    what: str
    first: int
    last: int


def activities(truth: GroundTruth | FlightTruth) -> tuple[Span, ...]:
    """What the robot did, from the first moment to the last."""
    if isinstance(truth, GroundTruth):
        return spans([_driven(m) for m in truth.moments])
    return spans([_flown(m, b) for b, m in zip(truth.moments, truth.moments[1:], strict=False)], 1)


def sightings(truth: GroundTruth) -> dict[str, tuple[Span, ...]]:
    """For each class of things that the plan asked for: when the detector reported it."""
    kinds = dict.fromkeys(kind for m in truth.moments for kind in m.reported)
    found = {k: spans(["seen" if m.reported.get(k) else "" for m in truth.moments]) for k in kinds}
    return {kind: tuple(s for s in all_of if s.what) for kind, all_of in found.items()}


def spans(whats: Sequence[str], offset: int = 0) -> tuple[Span, ...]:
    """Join what goes on for several moments. Value i belongs to the period that ends in moment i.

    Args:
        whats: What goes on, moment by moment.
        offset: Number of the first value's moment.
    """
    found, number = [], offset
    for what, group in groupby(whats):
        count = len(list(group))
        found.append(Span(what, max(0, number - 1), number + count - 1))
        number += count
    return tuple(s for s in found if s.last > s.first)


def _driven(moment: GroundMoment) -> str:
    if moment.contact:
        return "touches"
    if abs(moment.linear) > 1e-3:
        return "drives" if moment.linear > 0 else "backs up"
    if abs(moment.angular) > 1e-3:
        return "turns left" if moment.angular > 0 else "turns right"
    return "stands"


def _flown(moment: FlightMoment, before: FlightMoment) -> str:
    if moment.after_stop:
        return "on the ground" if before.is_on_ground else "lands"
    north, east, down = moment.setpoint
    if before.is_on_ground and moment.is_on_ground and down >= 0:
        return "on the ground"
    if abs(north) + abs(east) > 1e-9:
        return "flies"
    if down == 0:
        return "hovers"
    return "climbs" if down < 0 else "descends"
