"""A robot that moves exactly as its platform's model says, and senses what a function says."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping

from vaso.execution.robot import Health, Period
from vaso.plan.transition_system import Scalar
from vaso.platforms import Issued, Platform

__all__ = ["IdealRobot"]


class IdealRobot:
    """The model of a platform as a robot: no lag, no noise, no time but the number of periods.

    Its runs are paths of the plan's automaton, which makes it the robot to try a plan with, and to
    compare other robots with.

    Args:
        platform: The platform.
        sense: The value of a raw sensor in a state: (canonical name, number of the state) -> value.
            By default the first value of the sensor's domain, always.

    Attributes:
        commands: Every command so far.
        stopped: The reasons that :meth:`stop` was given.
    """

    is_simulated = True

    def __init__(
        self, platform: Platform, sense: Callable[[str, int], Scalar] | None = None
    ) -> None:
        self.name = f"ideal {platform.name}"
        self.platform = platform
        self.commands: list[Issued] = []
        self.stopped: list[str] = []
        self._sense = sense or self._first
        self._world: Hashable = platform.dynamics.initial()

    def connect(self) -> None:
        """Nothing to reach."""

    def start(self) -> None:
        """It is at rest."""

    def read(self, sensor: str) -> Scalar:
        """What the function says."""
        return self._sense(sensor, len(self.commands))

    def act(self, command: Issued) -> None:
        """Follow a command exactly."""
        self.commands.append(command)
        self._world = self.platform.dynamics.step(self._world, command)

    def wait(self) -> Period:
        """A period later."""
        dt = self.platform.dt
        return Period(time=round(len(self.commands) * dt, 9), seconds=dt)

    def measured(self) -> Mapping[str, float]:
        """The platform's numbers."""
        numeric = {p.name for p in self.platform.propositions if p.kind == "numeric"}
        truth = self.platform.dynamics.truth(self._world)
        return {name: float(value) for name, value in truth.items() if name in numeric}

    def stop(self, reason: str = "") -> None:
        """Stand still at once."""
        self.stopped.append(reason)

    def health(self) -> Health:
        """Always well."""
        return Health(ok=True)

    def close(self) -> None:
        """Nothing to let go of."""

    def _first(self, sensor: str, state: int) -> Scalar:
        spec = self.platform.sensor_of(sensor)
        return spec.domain[0] if spec else False
