"""An independent executor of plans: CPython itself, with sensors that follow a script.

It shares nothing with the exploration but the platform: labelling code and plan run by ``exec`` in
this process (they are the tests' own texts), each command or sleep moves to the next state.
"""

from __future__ import annotations

import builtins
import math
import types
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from vaso.platforms import Platform


class EnoughError(BaseException):
    """The scripted sensor values are used up."""


@dataclass
class Reference:
    """Runs a plan against one sequence of sensor valuations.

    Attributes:
        platform: The robot.
        valuations: The sensors' values in state 0, 1, 2, ...
        commands: The low-level command in force in each state so far.
    """

    platform: Platform
    valuations: Sequence[dict[str, bool]]
    commands: list[str] = field(default_factory=list)

    def run(self, code: str, plan: str) -> list[str]:
        """The commands in force in states 0 … len(valuations) - 1."""
        self.commands = [str(self.platform.rest)]
        clock = self._time()
        imports = {"time": clock, "math": math}
        own = {**vars(builtins), "__import__": lambda name, *_: imports[name]}
        names: dict[str, Any] = {"math": math, "time": clock, "__builtins__": own}
        for command in self.platform.commands:
            names[command.name] = lambda *a, c=command, **k: self._next(str(c.issue(a, k)))
        for sensor in self.platform.sensors:
            names[sensor.name] = lambda *a, s=sensor, **k: self._here[s.key(a, k)]
        try:
            exec(compile(code, "labelling", "exec"), names)
            exec(compile(plan, "plan", "exec"), names)
        except (EnoughError, ValueError, AssertionError):
            pass
        self.commands += [self.commands[-1]] * len(self.valuations)
        return self.commands[: len(self.valuations)]

    @property
    def _here(self) -> dict[str, bool]:
        return self.valuations[len(self.commands) - 1]

    def _next(self, command: str) -> None:
        self.commands.append(command)
        if len(self.commands) >= len(self.valuations):
            raise EnoughError

    def _sleep(self, seconds: float) -> None:
        for _ in range(math.ceil(round(seconds / self.platform.dt, 6))):
            self._next(self.commands[-1])

    def _now(self) -> float:
        return 1024.0 + round((len(self.commands) - 1) * self.platform.dt, 9)

    def _time(self) -> Any:
        return types.SimpleNamespace(time=self._now, monotonic=self._now, sleep=self._sleep)
