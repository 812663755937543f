"""One control period: bounds on every numeric proposition from its beginning to its end."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from vaso.dynamics.interval import EVERYTHING, ZERO, Interval, hull, inside, widened
from vaso.dynamics.motion import Constants, Motion, Path
from vaso.platforms.response import Greatest, Position, Response, Speed, Velocity

__all__ = ["Box", "Period", "SetPoints", "at_rest"]

SetPoints = tuple[tuple[float, ...], ...]
"""The set-point of each channel."""

TINY = 1e-12
"""Velocities and heights that are no more than a rounding error."""


@dataclass(frozen=True, slots=True)
class Box:
    """What is known of the motion at an instant.

    Attributes:
        velocities: Per channel, every component.
        norms: Per channel, a bound on the magnitude.
        positions: In the order of :attr:`~vaso.platforms.response.Response.positions`.
        aims: Where each position would be if every set-point were reached at once.
        highest: The greatest value of each position so far.
    """

    velocities: tuple[tuple[Interval, ...], ...]
    norms: tuple[float, ...]
    positions: tuple[Interval, ...]
    aims: tuple[Interval, ...]
    highest: tuple[Interval, ...]

    def covers(self, other: Box) -> bool:
        """True when this box contains another one."""
        pairs = zip(other._intervals(), self._intervals(), strict=True)
        norms = zip(other.norms, self.norms, strict=True)
        return all(inside(a, b) for a, b in pairs) and all(a <= b for a, b in norms)

    def joined(self, other: Box) -> Box:
        """The smallest box around two boxes."""
        pairs = zip(self.velocities, other.velocities, strict=True)
        return Box(
            tuple(_hulls(a, b) for a, b in pairs),
            tuple(map(max, self.norms, other.norms)),
            _hulls(self.positions, other.positions),
            _hulls(self.aims, other.aims),
            _hulls(self.highest, other.highest),
        )

    def _intervals(self) -> list[Interval]:
        return [
            *(v for c in self.velocities for v in c),
            *self.positions,
            *self.aims,
            *self.highest,
        ]


def at_rest(response: Response, setpoints: SetPoints) -> Box:
    """What is known before the first command: the vehicle follows the platform's rest command."""
    starts = tuple((p.start, p.start) for p in response.positions.values())
    exact = tuple(tuple((u, u) for u in channel) for channel in setpoints)
    return Box(exact, tuple(math.hypot(*u) for u in setpoints), starts, starts, starts)


class Period:
    """A control period in which one set-point of each channel is in force.

    Args:
        response: How the platform's set-points become motion.
        constants: What is known of the constants of each channel.
        start: What is known at the beginning.
        setpoints: The set-points in force.
    """

    def __init__(
        self,
        response: Response,
        constants: Sequence[Constants],
        start: Box,
        setpoints: SetPoints,
    ) -> None:
        self.response = response
        self.start = start
        self.index = {c.name: i for i, c in enumerate(response.channels)}
        self.free = tuple(
            Motion(*parts)
            for parts in zip(setpoints, start.velocities, start.norms, constants, strict=True)
        )
        self.places = response.positions
        self.order = {name: i for i, name in enumerate(self.places)}
        self._known: dict[tuple[float, float], dict[str, Interval]] = {}
        self._ends: dict[float, Box] = {}

    # --- the ground ----------------------------------------------------------------------------

    @cached_property
    def touching(self) -> tuple[Motion, ...]:
        """The motion of a vehicle that may have stood on the ground on the way."""
        return tuple(m.from_rest() for m in self.free)

    @cached_property
    def _ground(self) -> tuple[Position, Motion, Interval, float] | None:
        """The position with a floor, its channel, its height above the floor, its set-point."""
        if self.response.ground is None:
            return None
        place = self.places[self.response.ground]
        motion = self.free[self.index[place.channel]]
        low, high = self.start.positions[self.order[self.response.ground]]
        assert place.floor is not None
        height = (low - place.floor, high - place.floor)
        return place, motion, height, place.factor * motion.setpoint[place.component]

    @cached_property
    def stands(self) -> bool:
        """True when the vehicle surely stands on the ground for the whole period."""
        if self._ground is None:
            return False
        place, motion, (_, height), rise = self._ground
        path = motion.path(place.component, place.factor, upper=True)
        return height <= 0.0 and rise <= 0.0 and path.speed <= TINY

    def _may_touch(self, time: float) -> bool:
        """True when the vehicle may have been on the ground after the start and by a time."""
        if self._ground is None:
            return False
        place, motion, (height, _), rise = self._ground
        path = motion.path(place.component, place.factor, upper=False)
        if height <= TINY and rise > 0.0 and path.speed >= -TINY:
            return False  # it leaves the ground at once
        return height + path.over(0.0, time)[0] <= 0.0

    # --- bounds --------------------------------------------------------------------------------

    def values(self, begin: float, end: float) -> Mapping[str, Interval]:
        """Bounds on every quantity of the response, except those of set-points alone.

        Args:
            begin: Seconds since the beginning of the period.
            end: Seconds, not before ``begin``; may be infinite.
        """
        known = self._known.get((begin, end))
        if known is None:
            known = self._known[begin, end] = self._values(begin, end)
        return known

    def _values(self, begin: float, end: float) -> dict[str, Interval]:
        touched = not self.stands and self._may_touch(end)
        motions = self.touching if touched else self.free
        found: dict[str, Interval] = {}
        for name, quantity in self.response.quantities.items():
            match quantity:
                case Position():
                    found[name] = self._position(name, motions, begin, end)
                case Velocity(channel=channel, component=component):
                    moving = motions[self.index[channel]].velocity(component, begin, end)
                    found[name] = self._grounded(moving, touched)
                case Greatest(of=of):
                    found[name] = self._greatest(of, motions, begin, end)
                case Speed():
                    found[name] = self._speed(quantity, motions, begin, end, touched)
        return found

    def end(self, duration: float) -> Box:
        """What is known after some seconds, with room for rounding errors."""
        known = self._ends.get(duration)
        if known is None:
            known = self._ends[duration] = self._end(duration)
        return known

    def _end(self, duration: float) -> Box:
        instant = (duration, duration)
        touched = not self.stands and self._may_touch(duration)
        motions = self.touching if touched else self.free
        return Box(
            tuple(
                tuple(
                    self._exact(self._grounded(v, touched)) for v in m.velocities(*2 * [duration])
                )
                for m in motions
            ),
            tuple(self._norm(m, duration) for m in motions),
            tuple(self._position(n, motions, duration, duration, exact=False) for n in self.places),
            tuple(
                _raised(self._exact(self._aim(n, *instant)), place.floor)
                for n, place in self.places.items()
            ),
            tuple(
                _raised(self._exact(self._greatest(n, motions, *instant)), place.start)
                for n, place in self.places.items()
            ),
        )

    def _norm(self, motion: Motion, time: float) -> float:
        bound = motion.magnitude(time, time)
        return 0.0 if self.stands else widened((bound, bound))[1]

    def _exact(self, interval: Interval) -> Interval:
        return interval if self.stands else widened(interval)

    def _grounded(self, velocity: Interval, touched: bool) -> Interval:
        """A component of the velocity, given what is known of the ground."""
        if self.stands:
            return ZERO
        return hull([velocity, ZERO]) if touched else velocity

    def _position(
        self,
        name: str,
        motions: Sequence[Motion],
        begin: float,
        end: float,
        *,
        exact: bool = True,
    ) -> Interval:
        place = self.places[name]
        start = self.start.positions[self.order[name]]
        if self.stands:
            return start
        below, above = self._paths(place, motions)
        low, high = start[0] + below.over(begin, end)[0], start[1] + above.over(begin, end)[1]
        if motions[self.index[place.channel]].is_lag:
            first = start[0] + below.at(begin), start[1] + above.at(begin)
            least, most = self._lagging(name, motions, (begin, end), first)
            low, high = (low if place.floor is not None else max(low, least)), min(high, most)
        low, high = (low, high) if exact else widened((low, high))
        return _raised((low, high), place.floor)

    def _lagging(
        self, name: str, motions: Sequence[Motion], times: Interval, first: Interval
    ) -> Interval:
        """Tighter bounds for a pure lag: ``position + lag * velocity`` moves with the set-point.

        So the position is below the aim while it rises, and while it falls, below where it was
        (``first`` at the first of the times). With a floor, only the upper bound holds.
        """
        place = self.places[name]
        motion = motions[self.index[place.channel]]
        lag, begin = motion.constants.lags[1], times[0]
        rates = sorted(place.factor * v for v in motion.velocity(place.component, begin, begin))
        if motions is self.touching:
            rates = [min(rates[0], 0.0), max(rates[1], 0.0)]
        aims, aim = self._aim(name, *times), self._aim(name, begin, begin)
        fallen = min(first[1], aim[1] + lag * max(0.0, -rates[0]))
        risen = max(first[0], aim[0] - lag * max(0.0, rates[1]))
        return min(aims[0], risen), max(aims[1], fallen)

    def _aim(self, name: str, begin: float, end: float) -> Interval:
        """Where the set-point alone would lead, from one time to another."""
        place = self.places[name]
        if self.stands:
            return self.start.positions[self.order[name]]
        motion = self.free[self.index[place.channel]]
        rate = place.factor * motion.setpoint[place.component]
        low, high = self.start.aims[self.order[name]]
        ends = [rate * t if rate else 0.0 for t in (begin, end)]
        return _raised((low + min(ends), high + max(ends)), place.floor)

    def _paths(self, place: Position, motions: Sequence[Motion]) -> tuple[Path, Path]:
        """The lowest and the highest way from the start."""
        motion = motions[self.index[place.channel]]
        low, high = (
            motion.path(place.component, place.factor, upper=upper) for upper in (False, True)
        )
        return low, high

    def _greatest(self, of: str, motions: Sequence[Motion], begin: float, end: float) -> Interval:
        known, place = self.start.highest[self.order[of]], self.places[of]
        if self.stands:
            return known
        below, _ = self._paths(place, motions)
        least = self.start.positions[self.order[of]][0] + below.over(0.0, begin)[1]
        return max(known[0], least), max(known[1], self._position(of, motions, 0.0, end)[1])

    def _speed(
        self, speed: Speed, motions: Sequence[Motion], begin: float, end: float, touched: bool
    ) -> Interval:
        used = [motions[self.index[c]] for c in speed.channels]
        height = self._height(begin, end, motions) if speed.unless_on is not None else EVERYTHING
        if self.stands or height[1] <= 0.0:
            return ZERO
        parts = [v for m in used for v in m.velocities(begin, end)]
        low = 0.0 if touched else math.hypot(*(max(0.0, a, -b) for a, b in parts))
        if speed.unless_on is not None and height[0] <= 0.0:
            low = 0.0
        return low, math.hypot(*(m.magnitude(begin, end) for m in used))

    def _height(self, begin: float, end: float, motions: Sequence[Motion]) -> Interval:
        assert self.response.ground is not None
        floor = self.places[self.response.ground].floor or 0.0
        low, high = self._position(self.response.ground, motions, begin, end)
        return low - floor, high - floor


def _raised(interval: Interval, floor: float | None) -> Interval:
    """What is left of a position's bounds above its floor."""
    if floor is None:
        return interval
    return max(interval[0], floor), max(interval[1], floor)


def _hulls(first: Sequence[Interval], second: Sequence[Interval]) -> tuple[Interval, ...]:
    return tuple(hull(pair) for pair in zip(first, second, strict=True))
