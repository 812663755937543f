"""What a command leads to: the next state, and those after it when the robot is brought to rest.

A *backup* is a sequence of commands that ends with the platform's safe command for ever. A forecast
says for every state of it what is true: actions by the platform's truth, numbers by its model, and
bounds on numbers for every instant and every vehicle of the platform's class.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from vaso.dynamics.interval import Interval
from vaso.monitoring.estimate import Estimate
from vaso.plan.transition_system import Label
from vaso.platforms import Issued, Platform, Speed, Velocity
from vaso.platforms.model import Value

__all__ = ["Forecaster", "Phase", "backups"]

MAX_STEPS = 30
"""States under the safe command that are looked at where the model never comes to rest."""

RAMPS = (2, 4, 8)
"""Numbers of steps in which a command is turned into the safe one, where that at once is wrong."""


@dataclass(frozen=True, slots=True)
class Phase:
    """A state that is to come.

    Attributes:
        command: The command in force.
        truth: Actions and numbers by the platform's model.
        bounds: Every number, at every instant of the period.
    """

    command: Issued
    truth: Mapping[str, Label]
    bounds: Mapping[str, Interval]


class Forecaster:
    """Says what sequences of commands lead to from the present state.

    Args:
        platform: The platform.
        world: The state of its dynamics now.
        estimate: What is known of the motion; None where the platform has no response.
        errors: By how much measured numbers differ from the model's now.
        late: By how many seconds a period may be longer than it should.
    """

    def __init__(
        self,
        platform: Platform,
        world: Hashable,
        estimate: Estimate | None,
        errors: Mapping[str, float],
        late: float,
    ) -> None:
        self._platform = platform
        self._world = world
        self._estimate = estimate
        self._errors = errors
        self._late = late

    def run(self, commands: Sequence[Issued]) -> tuple[Phase, ...]:
        """The states under some commands, one a period; the last one goes on for ever."""
        bounds = self._bounds(commands)
        world = self._world
        phases: list[Phase] = []
        for command in commands:
            world = self._platform.dynamics.step(world, command)
            phases.append(self._phase(command, world, bounds[len(phases)]))
        for _ in range(MAX_STEPS):
            after = self._platform.dynamics.step(world, commands[-1])
            if after == world:
                break
            world = after
            phases.append(self._phase(commands[-1], world, bounds[-1]))
        return tuple(phases)

    def _bounds(self, commands: Sequence[Issued]) -> list[Mapping[str, Interval]]:
        """What the response says of each period; the last one has no end."""
        found: list[Mapping[str, Interval]] = []
        dt, estimate = self._platform.dt, self._estimate
        for index, command in enumerate(commands):
            setpoints = estimate.setpoints(command) if estimate is not None else None
            if estimate is None or setpoints is None:
                return [*found, *[{} for _ in commands[index:]]]
            last = index == len(commands) - 1
            found.append(estimate.bounds(setpoints, 0.0, math.inf if last else dt + self._late))
            if not last:
                estimate = estimate.after(setpoints, dt, dt + self._late)
        return found

    def _phase(self, command: Issued, world: Hashable, bounds: Mapping[str, Interval]) -> Phase:
        truth = self._platform.dynamics.truth(world)
        numbers = dict(bounds)
        for name, value in truth.items():
            if not isinstance(value, bool):
                low, high = self._number(name, value, bounds.get(name))
                margin = self._platform.margins.get(name, 0.0)
                numbers[name] = low - margin, high + margin
        return Phase(command, truth, numbers)

    def _number(self, name: str, value: float, bounds: Interval | None) -> Interval:
        """A number in a period, from its value in the model and what the response says of it.

        A position is held about the model's too, since an adapter may steer there. Of a speed, what
        is off by less than can be measured does not count: a command at exactly the limit that a
        rule allows would never do, as some drift from the period before is always possible.
        """
        response = self._platform.response
        kind = response.quantities.get(name) if response else None
        if bounds is None:
            corrected = value + self._errors.get(name, 0.0)
            return min(value, corrected), max(value, corrected)
        if isinstance(kind, Speed | Velocity):
            noise = self._platform.accuracy.get(name, 0.0)
            return min(value, bounds[0] + noise), max(value, bounds[1] - noise)
        return min(value, bounds[0]), max(value, bounds[1])


def backups(command: Issued, safe: Issued) -> Iterator[tuple[Issued, ...]]:
    """What may follow a command: the safe one at once, or after some steps towards it."""
    yield (safe,)
    if command == safe or not _alike(command, safe):
        return
    for steps in RAMPS:
        shares = [i / steps for i in range(1, steps)]
        yield (*(_between(command, safe, share) for share in shares), safe)


def _alike(one: Issued, other: Issued) -> bool:
    return one.name == other.name and [n for n, _ in one.arguments] == [
        n for n, _ in other.arguments
    ]


def _between(one: Issued, other: Issued, share: float) -> Issued:
    """A command between two, element by element."""

    def mix(a: float, b: float) -> float:
        return round(a + (b - a) * share, 9)

    arguments: list[tuple[str, Value]] = []
    for (name, a), (_, b) in zip(one.arguments, other.arguments, strict=True):
        if isinstance(a, tuple) and isinstance(b, tuple):
            arguments.append((name, tuple(map(mix, a, b))))
        elif isinstance(a, float) and isinstance(b, float):
            arguments.append((name, mix(a, b)))
    return Issued(name=one.name, arguments=tuple(arguments))
