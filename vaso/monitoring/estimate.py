"""What is known of the motion of a robot now, from its commands and its measurements.

The response of the platform bounds the motion under the commands so far (:mod:`vaso.dynamics`);
each measurement narrows the bounds down to its accuracy. Where a measurement contradicts them, the
vehicle is none of the class that the platform describes, and the measurement is believed. Positions
are always taken from the measurement, where there is one, since models of them drift.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import TypeVar

from vaso.dynamics.commands import setpoints_of
from vaso.dynamics.interval import Interval, hull, inside
from vaso.dynamics.period import Box, Period, SetPoints, at_rest
from vaso.dynamics.vehicles import whole
from vaso.platforms import (
    Channel,
    Greatest,
    Issued,
    Platform,
    Position,
    Response,
    SetPoint,
    Speed,
    Velocity,
)
from vaso.platforms.response import Quantity

__all__ = ["Estimate"]

T = TypeVar("T")


class Estimate:
    """Bounds on the motion of a robot. Values; a step makes a new one.

    Args:
        response: The part of the platform's response that matters.
        accuracy: By how much measured numbers may be off.
        box: The bounds.
        before: The measurements before.
    """

    def __init__(
        self,
        response: Response,
        accuracy: Mapping[str, float],
        box: Box,
        before: Mapping[str, float],
    ) -> None:
        self.response = response
        self.box = box
        self._accuracy = accuracy
        self._constants = whole(response)
        self._before = before
        self._bounds: dict[tuple[SetPoints, float, float], Mapping[str, Interval]] = {}
        self._after: dict[tuple[SetPoints, float, float], Estimate] = {}

    @classmethod
    def at_rest(cls, platform: Platform, names: Collection[str]) -> Estimate | None:
        """What is known before the first command.

        Args:
            platform: The platform.
            names: The numbers of interest.

        Returns:
            None where the platform's response says nothing about them, or nothing about what its
            rest and safe commands mean.
        """
        response = platform.response
        moving = [n for n in names if response and _moves(response.quantities.get(n))]
        if response is None or not moving:
            return None
        part = response.only(moving)
        found = [setpoints_of(c, part) for c in (platform.rest, platform.safe_command)]
        if found[0] is None or found[1] is None:
            return None
        return cls(part, platform.accuracy, at_rest(part, found[0]), {})

    def setpoints(self, command: Issued) -> SetPoints | None:
        """The set-points of a command; None where the response does not know it."""
        return setpoints_of(command, self.response)

    def bounds(self, setpoints: SetPoints, begin: float, end: float) -> Mapping[str, Interval]:
        """Every moving number between two times of the period that begins now."""
        key = setpoints, begin, end
        if key not in self._bounds:
            self._bounds[key] = self._period(setpoints).values(begin, end)
        return self._bounds[key]

    def after(self, setpoints: SetPoints, least: float, most: float) -> Estimate:
        """The bounds after a period whose length is between two values."""
        key = setpoints, least, most
        if key not in self._after:
            period = self._period(setpoints)
            box = period.end(least)
            box = box if least == most else box.joined(period.end(most))
            self._after[key] = Estimate(self.response, self._accuracy, box, self._before)
        return self._after[key]

    def measured(self, values: Mapping[str, float], seconds: float) -> Estimate:
        """The bounds with what was measured now.

        Args:
            values: Measured numbers by name; others than the response's are ignored.
            seconds: How long the last period was.
        """
        known = {n: v for n, v in values.items() if math.isfinite(v)}
        box = self._with_rates(self.box, known, seconds)
        for name, value in known.items():
            margin = self._accuracy.get(name, 0.0)
            box = self._with(box, name, (value - margin, value + margin))
        return Estimate(self.response, self._accuracy, self._with_aims(box), known)

    # --- one measurement -------------------------------------------------------------------------

    def _period(self, setpoints: SetPoints) -> Period:
        return Period(self.response, self._constants, self.box, setpoints)

    def _with(self, box: Box, name: str, value: Interval) -> Box:
        match self.response.quantities.get(name):
            case Position() as place:
                index = [*self.response.positions].index(name)
                floor = -math.inf if place.floor is None else place.floor
                value = max(value[0], floor), max(value[1], floor)
                # Not narrowed down by the model: drift would hide behind it for a while.
                return replace(box, positions=_replaced(box.positions, index, value))
            case Greatest(of=of):
                index = [*self.response.positions].index(of)
                return replace(box, highest=_put(box.highest, index, value))
            case Velocity(channel=channel, component=component):
                return self._with_velocity(box, channel, component, value)
            case Speed(channels=(channel,)) if self._channel(channel).size == 1:
                return self._with_scalar_speed(box, channel, value)
            case Speed(channels=channels) as speed:
                still = speed.unless_on is not None and value[0] <= 0.0
                return box if still else self._with_speed(box, channels, value)
        return box

    def _with_velocity(self, box: Box, name: str, component: int, value: Interval) -> Box:
        index = self._index(name)
        components = _put(box.velocities[index], component, value)
        return self._with_channel(box, index, components)

    def _with_scalar_speed(self, box: Box, name: str, value: Interval) -> Box:
        """A speed without its sign, of a channel that moves both ways."""
        index = self._index(name)
        ((low, high),) = box.velocities[index]
        least, most = max(0.0, value[0]), value[1]
        ways = [w for w in ((-most, -least), (least, most)) if w[0] <= high and low <= w[1]]
        met = [(max(low, a), min(high, b)) for a, b in ways] or [(-most, most)]
        return self._with_channel(box, index, (hull(met),))

    def _with_speed(self, box: Box, channels: tuple[str, ...], value: Interval) -> Box:
        """The speed over several channels: faster than the bounds allow, or one more bound."""
        used = [self._index(c) for c in channels]
        norms = list(box.norms)
        fastest = math.hypot(*(norms[i] for i in used))
        if value[0] > fastest:
            first = used[0]
            norms[first] = max(norms[first], value[1])
            wide = tuple((-value[1], value[1]) for _ in box.velocities[first])
            return replace(
                box, norms=tuple(norms), velocities=_replaced(box.velocities, first, wide)
            )
        for i in used:
            norms[i] = min(norms[i], value[1])
        return replace(box, norms=tuple(norms))

    def _with_rates(self, box: Box, values: Mapping[str, float], seconds: float) -> Box:
        """Velocities that positions tell of, where a position is beyond what was foretold."""
        for number, (name, place) in enumerate(self.response.positions.items()):
            before, now = self._before.get(name), values.get(name)
            if before is None or now is None or seconds <= 0.0:
                continue
            margin = self._accuracy.get(name, 0.0)
            low, high = box.positions[number]
            if low - margin <= now <= high + margin:
                continue
            rate = (now - before) / seconds / place.factor
            index = self._index(place.channel)
            slow, fast = box.velocities[index][place.component]
            span = min(slow, rate), max(fast, rate)
            components = _replaced(box.velocities[index], place.component, span)
            box = self._with_channel(box, index, components)
        return box

    def _with_channel(self, box: Box, index: int, components: tuple[Interval, ...]) -> Box:
        """The bounds with other ones for a velocity; its magnitude is known if they are inside."""
        norm = math.hypot(*(max(abs(a), abs(b)) for a, b in components))
        if all(map(inside, components, box.velocities[index])):
            norm = min(norm, box.norms[index])
        return replace(
            box,
            velocities=_replaced(box.velocities, index, components),
            norms=_replaced(box.norms, index, norm),
        )

    def _with_aims(self, box: Box) -> Box:
        """Where the set-points alone would lead: position + lag * velocity, for a pure lag."""
        aims = []
        for place, (low, high) in zip(self.response.positions.values(), box.positions, strict=True):
            index = self._index(place.channel)
            lag = self._constants[index].lags[1]
            rates = [place.factor * v for v in box.velocities[index][place.component]]
            aims.append((low + lag * min(0.0, *rates), high + lag * max(0.0, *rates)))
        highest = tuple(
            (max(h[0], p[0]), max(h[1], p[1]))
            for h, p in zip(box.highest, box.positions, strict=True)
        )
        return replace(box, aims=tuple(aims), highest=highest)

    def _index(self, channel: str) -> int:
        return next(i for i, c in enumerate(self.response.channels) if c.name == channel)

    def _channel(self, name: str) -> Channel:
        return self.response.channels[self._index(name)]


def _moves(quantity: Quantity | None) -> bool:
    """Whether the response bounds a number between samples."""
    return quantity is not None and not isinstance(quantity, SetPoint)


def _put(intervals: tuple[Interval, ...], index: int, value: Interval) -> tuple[Interval, ...]:
    """Narrow one of some intervals down; where that leaves nothing, believe the new one."""
    low, high = max(intervals[index][0], value[0]), min(intervals[index][1], value[1])
    return _replaced(intervals, index, (low, high) if low <= high else value)


def _replaced(values: tuple[T, ...], index: int, value: T) -> tuple[T, ...]:
    return (*values[:index], value, *values[index + 1 :])
