"""How the set-points of a platform become motion between two samples.

A sampled model says where a vehicle is at the end of each control period. A *response* says what
happens inside: each velocity set-point u is followed with first-order lag and limited acceleration,

    dv/dt = e / |e| * min(|e| / lag, acceleration),    e = u - v,

where lag and acceleration are unknown constants in given ranges. ``docs/between_samples.md`` says
what can be concluded from that.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, model_validator

Range: TypeAlias = tuple[float, float]
"""The least and the greatest value that a constant of the vehicle may have."""


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Channel(_Model):
    """A velocity, scalar or vector, that follows a set-point.

    Attributes:
        name: Its name, for example ``horizontal``.
        parameter: The parameter of a command that is its set-point.
        components: For a vector parameter, the elements that belong to this channel.
        lag: Time constant in seconds: the greatest, or (least, greatest). 0 is none.
        acceleration: Limit of the acceleration: the least that the vehicle can do, or (least,
            greatest). Infinite is none.
        fixed: Set-points of commands that lack the parameter, by command name.
    """

    name: str
    parameter: str
    components: tuple[int, ...] | None = None
    lag: float | Range = 0.0
    acceleration: float | Range = math.inf
    fixed: Mapping[str, tuple[float, ...]] = Field(default_factory=dict)

    @property
    def size(self) -> int:
        """Number of its components."""
        return 1 if self.components is None else len(self.components)

    @property
    def lags(self) -> Range:
        """The least and the greatest time constant."""
        return self.lag if isinstance(self.lag, tuple) else (0.0, self.lag)

    @property
    def accelerations(self) -> Range:
        """The least and the greatest limit of the acceleration."""
        given = self.acceleration
        return given if isinstance(given, tuple) else (given, math.inf)

    def setpoint(
        self, command: str, arguments: Mapping[str, float | tuple[float, ...]]
    ) -> tuple[float, ...] | None:
        """The set-point in a command; None where the command does not say."""
        found = arguments.get(self.parameter)
        if found is None:
            return self.fixed.get(command)
        if isinstance(found, tuple):
            wanted = self.components or ()
            return tuple(found[i] for i in wanted) if wanted and max(wanted) < len(found) else None
        return (found,) if self.components is None else None

    @model_validator(mode="after")
    def _possible(self) -> Self:
        for least, most, what in ((*self.lags, "lag"), (*self.accelerations, "acceleration")):
            if not 0 <= least <= most:
                raise ValueError(f"channel {self.name}: {what} {least} to {most} is no range")
        if math.isinf(self.lags[1]) or self.accelerations[0] == 0:
            raise ValueError(f"channel {self.name} never follows its set-point")
        if any(len(values) != self.size for values in self.fixed.values()):
            raise ValueError(f"channel {self.name}: a fixed set-point needs {self.size} numbers")
        return self


class Speed(_Model):
    """The magnitude of the velocity over some channels together.

    Attributes:
        channels: Names of channels.
        unless_on: A position with a floor; the speed counts as 0 while it is at the floor.
    """

    kind: Literal["speed"] = "speed"
    channels: tuple[str, ...]
    unless_on: str | None = None


class Velocity(_Model):
    """One component of a channel's velocity, with its sign."""

    kind: Literal["velocity"] = "velocity"
    channel: str
    component: int = 0


class Position(_Model):
    """The integral of one component of a channel's velocity.

    Attributes:
        channel: Name of the channel.
        component: Which of its components.
        factor: What the velocity is multiplied by: -1.0 for a height over a velocity downwards.
        start: The position at rest, before the first command.
        floor: The ground, below which the position cannot fall. While a vehicle is on the ground
            and its set-point does not point away from it, it stands still in all channels.
    """

    kind: Literal["position"] = "position"
    channel: str
    component: int = 0
    factor: float = 1.0
    start: float = 0.0
    floor: float | None = None


class Greatest(_Model):
    """The greatest value that a position has had so far."""

    kind: Literal["greatest"] = "greatest"
    of: str


class SetPoint(_Model):
    """A number about set-points alone: it does not change inside a period."""

    kind: Literal["setpoint"] = "setpoint"


Quantity: TypeAlias = Annotated[
    Speed | Velocity | Position | Greatest | SetPoint, Field(discriminator="kind")
]


class Response(_Model):
    """How a platform's set-points become motion.

    Attributes:
        channels: The velocities that follow set-points.
        quantities: What each numeric proposition is in terms of that motion.
        source: Where the numbers come from.
    """

    channels: tuple[Channel, ...]
    quantities: Mapping[str, Quantity]
    source: str = ""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        names = [c.name for c in self.channels]
        if len(set(names)) != len(names) or not names:
            raise ValueError("a response needs channels with different names")
        for name, quantity in self.quantities.items():
            for problem in self._problems(quantity):
                raise ValueError(f"the response's quantity {name} {problem}")
        if sum(p.floor is not None for p in self.positions.values()) > 1:
            raise ValueError("only one position can have a floor")
        return self

    def _problems(self, quantity: Quantity) -> Iterator[str]:
        sizes = {c.name: c.size for c in self.channels}
        positions = self.positions
        match quantity:
            case Speed(channels=used, unless_on=ground):
                yield from (f"uses the unknown channel {c}" for c in used if c not in sizes)
                if ground is not None and (ground not in positions or self.ground != ground):
                    yield f"depends on {ground}, which is no position with a floor"
            case (
                Velocity(channel=channel, component=component)
                | Position(channel=channel, component=component)
            ):
                if not 0 <= component < sizes.get(channel, 0):
                    yield f"uses component {component} of {channel}, which does not exist"
            case Greatest(of=of):
                if of not in positions:
                    yield f"depends on {of}, which is no position"
        if isinstance(quantity, Position):
            if quantity.factor == 0 or not math.isfinite(quantity.factor):
                yield "needs a factor other than 0"
            if quantity.floor is not None and quantity.start < quantity.floor:
                yield "starts below its floor"

    @cached_property
    def positions(self) -> dict[str, Position]:
        """The quantities that are positions."""
        return {n: q for n, q in self.quantities.items() if isinstance(q, Position)}

    @cached_property
    def ground(self) -> str | None:
        """The position that has a floor, if one has."""
        return next((n for n, p in self.positions.items() if p.floor is not None), None)

    def only(self, names: Collection[str]) -> Response:
        """The response without channels and quantities that do not matter for some quantities."""
        wanted = {*names, *([self.ground] if self.ground else [])}
        wanted |= {q.of for n in names if isinstance(q := self.quantities.get(n), Greatest)}
        used = set().union(*(self.channels_of(n) for n in wanted))
        return Response(
            channels=tuple(c for c in self.channels if c.name in used),
            quantities={n: q for n, q in self.quantities.items() if n in wanted},
            source=self.source,
        )

    def channels_of(self, name: str) -> set[str]:
        """The names of the channels that a quantity is about."""
        match self.quantities.get(name):
            case Position(channel=channel) | Velocity(channel=channel):
                return {channel}
            case Speed(channels=used):
                return set(used)
            case Greatest(of=of):
                return self.channels_of(of)
        return set()

    @property
    def vehicle(self) -> str:
        """The class of vehicles in words, to follow "every vehicle that"."""
        lags = [(c.name, _span(*c.lags, "s")) for c in self.channels if c.lags[1]]
        limits = [
            (c.name, _limit(*c.accelerations))
            for c in self.channels
            if math.isfinite(c.accelerations[0])
        ]
        told = [
            f"with {what} of {_list(values, len(self.channels))}"
            for what, values in (("a lag", lags), ("an acceleration", limits))
            if values
        ]
        return f"follows set-points {' and '.join(told) or 'at once'}"


def _span(least: float, most: float, unit: str) -> str:
    return f"{least:g} to {most:g} {unit}" if least else f"at most {most:g} {unit}"


def _limit(least: float, most: float) -> str:
    if math.isinf(most):
        return f"at least {least:g}"
    return f"{least:g}" if least == most else f"{least:g} to {most:g}"


def _list(values: Sequence[tuple[str, str]], channels: int) -> str:
    """One value that all channels share, or each with the name of its channel."""
    if len(values) == channels and len({text for _, text in values}) == 1:
        return values[0][1]
    return " and ".join(f"{text} ({name})" for name, text in values)
