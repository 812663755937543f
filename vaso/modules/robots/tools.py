"""A robot as a tool module: its commands and sensors as tools of an agent."""

from __future__ import annotations

import math
from types import TracebackType
from typing import Any, Self

import dspy

from vaso.errors import VasoError
from vaso.execution import Guard, Robot
from vaso.platforms import Command, Issued, SensorSpec

__all__ = ["RobotTools"]

MOST_SECONDS = 10.0
"""The longest time for which one call may keep a command in force."""


class RobotTools(dspy.Module):  # type: ignore[misc]
    """The commands and sensors of a robot as ``dspy.Tool`` s, for ``dspy.ReAct``.

    An agent thinks for seconds between two calls, so no command outlives its call: it is in force
    for the time that the call asks for, and the robot is at rest again before the call returns.
    What goes wrong is said in the answer and not raised (only dspy's own check of the arguments'
    types raises). Use as a context manager, which connects the robot, and stops it at the end.

    Nothing is verified here: for a verified plan use :func:`vaso.modules.skill_tool` with an
    ``execute`` that runs it on the robot. A shield is the only thing between agent and robot.

    Args:
        robot: The robot.
        shield: Judges every command before it goes out, in each period.
    """

    def __init__(self, robot: Robot, *, shield: Guard | None = None) -> None:
        super().__init__()
        self.robot = robot
        self.shield = shield
        self._last = robot.platform.rest

    def __enter__(self) -> Self:
        """Connect and start.

        Raises:
            RobotError: The robot cannot be reached, or refuses.
        """
        try:
            self.robot.connect()
            self.robot.start()
        except BaseException:
            self.robot.stop("it did not start")
            self.robot.close()
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop, and let go of the robot."""
        self.robot.stop("" if error is None else f"{type(error).__name__}: {error}")
        self.robot.close()

    @property
    def tools(self) -> list[dspy.Tool]:
        """One tool for each command and sensor of the platform, and ``robot_state``."""
        platform = self.robot.platform
        return [
            *(self._command(c) for c in platform.commands),
            *(self._sensor(s) for s in platform.sensors),
            dspy.Tool(self.robot_state, name="robot_state"),
        ]

    def robot_state(self) -> str:
        """Measured numbers, and what the robot says of itself."""
        return _said(lambda: f"{self._numbers()}; {_health(self.robot)}")

    def _command(self, command: Command) -> dspy.Tool:
        def call(seconds: float | None = None, **arguments: Any) -> str:
            return _said(lambda: self._execute(command.issue((), arguments), seconds))

        number: dict[str, Any] = {"type": "number"}
        schema = {p.name: _schema(p.size) for p in command.parameters}
        return dspy.Tool(
            call,
            name=command.name,
            desc=f"{command.doc} In force for `seconds` (by default one control period of "
            f"{self.robot.platform.dt:g} s, at most {MOST_SECONDS:g} s); then the robot rests.",
            args={**schema, "seconds": number},
            arg_desc={p.name: p.unit for p in command.parameters if p.unit},
        )

    def _sensor(self, sensor: SensorSpec) -> dspy.Tool:
        def call(**arguments: Any) -> str:
            return _said(lambda: f"{self.robot.read(sensor.key((), arguments))}")

        return dspy.Tool(
            call,
            name=sensor.name,
            desc=sensor.doc or f"Reads {sensor.name}.",
            args={name: {"type": "string"} for name in sensor.parameters},
        )

    def _execute(self, command: Issued, seconds: float | None) -> str:
        dt = self.robot.platform.dt
        wanted = dt if seconds is None else float(seconds)
        if not 0 < wanted <= MOST_SECONDS:
            return f"seconds must be above 0 and at most {MOST_SECONDS:g}, not {wanted:g}"
        replaced = ""
        try:
            for _ in range(math.ceil(round(wanted / dt, 6))):
                replaced = self._period(command)
                if replaced:
                    break
            return replaced or f"done; at its end {self._numbers()}"
        finally:
            self._rest()

    def _rest(self) -> None:
        """A period at rest, also where a sensor is silent that the shield needs."""
        rest = self.robot.platform.rest
        try:
            self._period(rest)
        except BaseException:
            self.robot.act(rest)
            self._last = rest
            raise

    def _period(self, command: Issued) -> str:
        """One control period; why another command was in force, or nothing."""
        why = ""
        if self.shield is not None:
            self.shield.observe(self._labels(), self.robot.measured())
            ruling = self.shield.judge(command, "")
            command = ruling.command
            if ruling.intervention is not None:
                why = f"refused: {ruling.intervention.reason} ({ruling.intervention.rule})"
        self.robot.act(command)
        self._last = command
        self.robot.wait()
        return why

    def _labels(self) -> dict[str, bool | float]:
        """The platform's propositions now."""
        platform = self.robot.platform
        dynamics = platform.dynamics
        found = dict(dynamics.truth(dynamics.step(dynamics.initial(), self._last)))
        found.update(self.robot.measured())
        for spec in platform.propositions:
            if spec.sensor is not None:
                found[spec.name] = bool(self.robot.read(spec.sensor))
        return found

    def _numbers(self) -> str:
        values = (f"{name} {value:.2f}" for name, value in self.robot.measured().items())
        return ", ".join(values) or "nothing is measured"


def _schema(size: int | None) -> dict[str, Any]:
    if size is None:
        return {"type": "number"}
    return {"type": "array", "items": {"type": "number"}, "minItems": size, "maxItems": size}


def _health(robot: Robot) -> str:
    health = robot.health()
    told = [*health.problems, *(f"{k}: {v}" for k, v in health.details.items())]
    return ("well" if health.ok else "not well") + (f" ({'; '.join(told)})" if told else "")


def _said(act: Any) -> str:
    try:
        return str(act())
    except VasoError as error:
        return f"failed: {error}"
