"""Clauses about a flight around a square."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from vaso.simulation.geometry import Point
from vaso.simulation.tasks.clause import Clause, Found, Metres, Seconds
from vaso.simulation.tasks.corners import corners_of, is_clockwise, is_right_angled, sides_of
from vaso.simulation.truth import FlightMoment, FlightTruth

__all__ = ["FlightClause"]

MOVING = 0.05
"""Horizontal set-points below this are standing still, in m/s."""
HOVER = 0.3
"""A vehicle slower than this hovers, in m/s: it needs a second or two to come to rest, and wind
moves it."""
GROUND = 0.1
"""Metres."""
Speed: TypeAlias = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class Square(Clause):
    """The level part of the flight is a closed square.

    Attributes:
        side: Length of its sides in metres; None for any length.
        within: Tolerance in metres, of each side and of the way from the end to the start.
        sense: Which way round, seen from above; None for either.
        bend: Tolerance of the right angles, in degrees.
    """

    kind: Literal["square"] = "square"
    side: Metres | None = None
    within: Metres
    sense: Literal["clockwise", "counterclockwise"] | None = None
    bend: float = 20.0

    def judge(self, run: FlightTruth) -> Found:
        """Judge a flight."""
        path = [point for point, _ in round_of(run)]
        if len(path) < 3:
            return Found(False, "flies no sides")
        if math.dist(path[0], path[-1]) > self.within:
            gap = math.dist(path[0], path[-1])
            return Found(False, f"ends its round {gap:.1f} m from its start")
        corners = corners_of(path, self._tolerance(path))
        if len(corners) != 4:
            return Found(False, f"flies a path with {len(corners)} corners")
        sides = sides_of(corners)
        told = f"flies sides of {', '.join(f'{s:.1f}' for s in sides)} m"
        wanted = self.side if self.side is not None else sum(sides) / 4
        if any(abs(s - wanted) > self.within for s in sides):
            return Found(False, f"{told} ({wanted:.2g} ± {self.within:g})")
        if not is_right_angled(corners, math.radians(self.bend)):
            return Found(False, f"{told} that are not at right angles")
        sense = "clockwise" if is_clockwise(corners) else "counterclockwise"
        return Found(self.sense in (None, sense), f"{told}, {sense}")

    def _tolerance(self, path: Sequence[Point]) -> float:
        """How far the path may stray from the polygon: a fifth of the size of what was flown."""
        size = max(max(p[i] for p in path) - min(p[i] for p in path) for i in (0, 1))
        return 0.2 * min(size, self.side or size)


class Altitude(Clause):
    """The height above the ground while the vehicle flies its round.

    Attributes:
        metres: Metres.
        within: Tolerance in metres.
    """

    kind: Literal["altitude"] = "altitude"
    metres: Metres
    within: Metres

    def judge(self, run: FlightTruth) -> Found:
        """Judge a flight."""
        heights = [height for _, height in round_of(run)]
        if not heights:
            return Found(False, "flies no sides")
        low, high = min(heights), max(heights)
        told = f"flies at {low:.1f} to {high:.1f} m ({self.metres:g} ± {self.within:g})"
        return Found(max(self.metres - low, high - self.metres) <= self.within, told)


class SideSpeed(Clause):
    """The average speed on the sides.

    Attributes:
        mps: Metres per second.
        within: Tolerance.
    """

    kind: Literal["side_speed"] = "side_speed"
    mps: Speed
    within: Speed

    def judge(self, run: FlightTruth) -> Found:
        """Judge a flight."""
        speeds = [_horizontal(m.setpoint) for m in _sideways(run)]
        if not speeds:
            return Found(False, "flies no sides")
        true = _average_speed(run)
        told = f"flies the sides at {true:.2f} m/s ({self.mps:g} ± {self.within:g})"
        return Found(abs(true - self.mps) <= self.within, told)


class SpeedBelow(Clause):
    """The vehicle is never faster than this on its round.

    Attributes:
        mps: Metres per second.
        gusts: What the wind may add, in m/s.
    """

    kind: Literal["speed_below"] = "speed_below"
    mps: Speed
    gusts: Annotated[float, Field(ge=0)] = 0.1

    def judge(self, run: FlightTruth) -> Found:
        """Judge a flight."""
        sides = _level(run)
        if not sides:
            return Found(False, "flies no sides")
        most = max(_horizontal(m.velocity) for m in sides)
        told = f"flies at most {most:.2f} m/s (below {self.mps:g}, and {self.gusts:g} for gusts)"
        return Found(most < self.mps + self.gusts, told)


class Pauses(Clause):
    """The vehicle waits at the corners of its round.

    Attributes:
        seconds: How long, at each corner.
        corners: How many corners.
    """

    kind: Literal["pauses"] = "pauses"
    seconds: Seconds
    corners: int = 4

    def judge(self, run: FlightTruth) -> Found:
        """Judge a flight."""
        waits = [
            len(list(moments)) * run.dt
            for is_side, moments in groupby(_level(run, after=True), key=_is_side)
            if not is_side
        ]
        long = [w for w in waits if w >= self.seconds - 1e-6]
        told = f"waits at {len(long)} corners for {self.seconds:g} s ({self.corners})"
        return Found(len(long) >= self.corners, told)


class Hovers(Clause):
    """The vehicle hovers before its first side.

    Attributes:
        seconds: How long.
    """

    kind: Literal["hovers_first"] = "hovers_first"
    seconds: Seconds

    def judge(self, run: FlightTruth) -> Found:
        """Judge a flight."""
        moments = flying(run)
        first = next((i for i, m in enumerate(moments) if _is_side(m)), None)
        if first is None:
            return Found(False, "flies no sides")
        hovering = 0
        for moment in reversed(moments[:first]):
            if moment.altitude < GROUND or math.hypot(*moment.setpoint) > MOVING:
                break
            hovering += 1
        ready = moments[first - 1] if first else None
        is_slow = ready is not None and ready.speed < HOVER and hovering > 0
        told = f"hovers {hovering * run.dt:g} s before the first side (at least {self.seconds:g})"
        return Found(is_slow and hovering * run.dt >= self.seconds - 1e-6, told)


class Lands(Clause):
    """The flight takes off, and the plan ends it on the ground, at rest."""

    kind: Literal["lands"] = "lands"

    def judge(self, run: FlightTruth) -> Found:
        """Judge a flight."""
        last = flying(run)[-1]
        if max(m.altitude for m in run.moments) < GROUND:
            return Found(False, "does not take off")
        is_down = last.is_on_ground or last.altitude < GROUND
        told = "lands" if is_down else f"ends {last.altitude:.1f} m above the ground"
        return Found(is_down and last.speed < HOVER, told)


FlightClause: TypeAlias = Square | Altitude | SideSpeed | SpeedBelow | Pauses | Hovers | Lands


def flying(run: FlightTruth) -> Sequence[FlightMoment]:
    """The moments in which the plan was in command."""
    return [m for m in run.moments if not m.after_stop] or run.moments


def round_of(run: FlightTruth) -> list[tuple[Point, float]]:
    """Positions and heights from the first set-point sideways until after the last one."""
    level = _level(run)
    if not level:
        return []
    start, end = level[0].time - run.dt, level[-1].time + run.dt
    return [((n, e), h) for t, n, e, h in run.track if start - 1e-6 <= t <= end + 1e-6]


def _level(run: FlightTruth, *, after: bool = False) -> Sequence[FlightMoment]:
    """The moments from the first side to the last; with the pause after it, if asked for."""
    moments = flying(run)
    sides = [i for i, m in enumerate(moments) if _is_side(m)]
    if not sides:
        return []
    end = sides[-1] + 1
    while after and end < len(moments) and math.hypot(*moments[end].setpoint) <= MOVING:
        end += 1
    return moments[sides[0] : end]


def _sideways(run: FlightTruth) -> Sequence[FlightMoment]:
    return [m for m in _level(run) if _is_side(m)]


def _is_side(moment: FlightMoment) -> bool:
    return _horizontal(moment.setpoint) > MOVING


def _horizontal(velocity: Sequence[float]) -> float:
    return math.hypot(velocity[0], velocity[1])


def _average_speed(run: FlightTruth) -> float:
    """Metres flown sideways, over the time for which the plan flies sideways."""
    path = [point for point, _ in round_of(run)]
    length = sum(sides_of(corners_of(path, 0.3))) if len(path) > 2 else 0.0
    return length / (len(_sideways(run)) * run.dt)
