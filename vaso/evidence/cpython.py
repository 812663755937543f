"""Run a plan in CPython itself, with sensors that follow a script and a clock that only it moves.

This is the other side of the simulation test: it shares nothing with exploration but the platform.
It executes what it is given in this process. So it is for programs that VASO or its tests wrote
(random plans, shipped templates, their mutants), never for what a model or a user wrote.
"""

from __future__ import annotations

import builtins
import inspect
import math
import sys
import types
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from vaso.evidence.fingerprint import fingerprint
from vaso.evidence.functions import compiled, functions_of, sent_commands
from vaso.plan.transition_system import Label, Scalar
from vaso.platforms import Issued, Platform, get_platform
from vaso.skill import Skill

Valuation = Mapping[str, Scalar]
EPOCH = 1024.0
WALL = 131072.0
"""What ``time.time()`` is ahead of ``time.monotonic()``."""
TICK = 2.0**-30
"""The virtual clock's resolution in seconds; a period lasts the next multiple of it."""
LINES = 200_000
"""Lines of Python that may be executed between two commands."""
READS = 1_000
"""Reads that a state may have, before the period passes."""


@dataclass
class Sample:
    """One state of a run.

    Attributes:
        command: The low-level command in force.
        labels: The propositions' values; None where labelling code was still busy.
    """

    command: str
    labels: dict[str, Label] | None = None


class ScriptEndedError(BaseException):
    """The run is as long as the script; plans that catch exceptions do not catch this one."""


class TooLongError(BaseException):
    """The plan computes on and on without a command."""


def run_in_cpython(plan: str, skill: Skill, script: Sequence[Valuation]) -> list[Sample]:
    """Run a plan and label each state.

    Args:
        plan: The plan's text; trusted.
        skill: Supplies the labelling code and the platform.
        script: The sensors' values in state 0, 1, 2, …; a sensor that it does not mention raises.

    Returns:
        One sample per element of the script.

    Raises:
        KeyError: The plan reads a sensor that the script does not mention.
        TooLongError: The plan computes for too long between two commands.
    """
    return _Run(skill, script).run(plan)


@dataclass
class _Run:
    """One run. ``_depth`` counts functions of the labelling code that are being executed."""

    skill: Skill
    script: Sequence[Valuation]
    samples: list[Sample] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.platform: Platform = get_platform(self.skill.platform)
        self._issued: list[Issued] = []
        self._world = self.platform.dynamics.initial()
        self._depth = 0
        self._api = ""
        self._origin = "rest"
        self._seen: set[Any] = set()
        self._lines = 0

    def run(self, plan: str) -> list[Sample]:
        names = self._namespace()
        exec(compiled(self.skill.labelling_code), names)
        self._functions = functions_of(names)
        self._sends = sent_commands(self.skill.labelling_code, self.skill.platform)
        names |= {n: self._outermost(n, f) for n, f in self._functions.items()}
        self._names = names
        self._place(self.platform.rest)
        try:
            self._watched(lambda: exec(compile(plan, "<plan>", "exec"), names))
            if not self._moved and isinstance(names.get("vel_traj"), list):
                self._fly(names["vel_traj"])
        except ScriptEndedError:
            return self.samples
        except Exception as error:
            if isinstance(error, KeyError) and error.args[:1] == ("no such sensor",):
                raise
        self._rest()
        return self.samples

    # --- the world -----------------------------------------------------------------------------

    def _namespace(self) -> dict[str, Any]:
        ways: dict[str, Callable[[], float]] = {
            "time": lambda: self._now() + WALL,
            "monotonic": lambda: self._now(),
            "perf_counter": lambda: self._now(),
        }
        whole = {f"{n}_ns": lambda tell=tell: round(tell() * 1e9) for n, tell in ways.items()}
        clock = types.SimpleNamespace(**ways, **whole, sleep=self._sleep)

        def imported(name: str, *rest: Any) -> Any:
            return clock if name == "time" else __import__(name, *rest)

        own = {**vars(builtins), "__import__": imported, "print": lambda *_, **__: None}
        names: dict[str, Any] = {"math": math, "time": clock, "__name__": "__main__"}
        names["__builtins__"] = own
        for command in self.platform.commands:
            names[command.name] = lambda *a, c=command, **k: self._command(c.issue(a, k))
        for sensor in self.platform.sensors:
            names[sensor.name] = lambda *a, s=sensor, **k: self._read(s.key(a, k))
        return names

    @property
    def _moved(self) -> bool:
        return len(self._issued) > 1

    def _place(self, issued: Issued) -> None:
        """Enter the next state."""
        if len(self.samples) >= len(self.script):
            raise ScriptEndedError
        if self.samples:
            self._world = self.platform.dynamics.step(self._world, issued)
        self._seen, self._lines = set(), 0
        self._issued.append(issued)
        self.samples.append(Sample(str(issued)))

    def _begin(self) -> None:
        """Label the state at rest once the plan has made its settings, before it does anything."""
        if not self._depth and self.samples[0].labels is None:
            self._label()

    def _command(self, issued: Issued) -> None:
        self._begin()
        self._origin = "function" if self._depth else "plan"
        self._place(issued)
        if not self._depth:
            self._api = ""
            self._label()

    def _sleep(self, seconds: float) -> None:
        if seconds < 0:
            raise ValueError("sleep length must be non-negative")
        for _ in range(math.ceil(round(seconds / self.platform.dt, 6))):
            self._hold()

    def _hold(self) -> None:
        self._begin()
        self._place(self._issued[-1])
        if not self._depth:
            self._label()

    def _now(self) -> float:
        self._notice()
        period = math.ceil(self.platform.dt / TICK) * TICK
        return EPOCH + (len(self.samples) - 1) * period

    def _read(self, key: str) -> Scalar:
        self._notice()
        valuation = self.script[len(self.samples) - 1]
        if key not in valuation:
            raise KeyError("no such sensor", key)
        return valuation[key]

    def _notice(self) -> None:
        """A plan that is back where it was, with nothing done, waits: the period passes.

        So it does for one that reads and reads without coming back, such as one that counts.
        """
        if self._depth:
            return
        self._begin()
        here = fingerprint(sys._getframe(2), self._names)
        if here in self._seen or len(self._seen) > READS:
            self._hold()
        self._seen.add(here)

    def _rest(self) -> None:
        """The last command goes on."""
        self._begin()
        while len(self.samples) < len(self.script):
            self._hold()

    def _fly(self, points: list[Any]) -> None:
        [command] = self.platform.commands
        self._begin()
        self._api, self._origin = "", "trajectory"
        for point in points:
            self._place(command.issue((point,), {}))
            self._label()

    # --- functions of the labelling code ---------------------------------------------------------

    def _outermost(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, noting when the plan itself calls it."""

        def call(*args: Any, **kwargs: Any) -> Any:
            if self._depth:
                return function(*args, **kwargs)
            self._notice()
            length = len(self.samples)
            self._depth, before, self._api = 1, self._api, name
            try:
                return function(*args, **kwargs)
            finally:
                self._depth = 0
                if len(self.samples) == length:
                    self._api = before
                elif not isinstance(sys.exc_info()[1], ScriptEndedError):
                    self._label()

        call.__name__ = name
        return call

    # --- labels --------------------------------------------------------------------------------

    def _label(self) -> None:
        """Label the state, after the labelling code has done its work in it."""
        depth, self._depth = self._depth, 1
        truth = self.platform.dynamics.truth(self._world)
        labels = {p.name: self._standard(p.name, truth) for p in self.platform.propositions}
        labels |= {n: self._own(n, truth) for n in self._functions}
        self._depth = depth
        found = {n: round(v, 9) if type(v) is float else v for n, v in labels.items()}
        self.samples[-1].labels = {n: v for n, v in found.items() if v is not None}

    def _standard(self, name: str, truth: Mapping[str, Label]) -> Label | None:
        spec = self.platform.proposition(name)
        if name in truth or spec is None or spec.sensor is None:
            return truth.get(name)
        return bool(self.script[len(self.samples) - 1].get(spec.sensor, False))

    def _own(self, name: str, truth: Mapping[str, Label]) -> Label | None:
        """What the skill's function of this name means here; None for what is no proposition."""
        spec = self.platform.proposition(name)
        if self._sends[name] is not None or (spec is not None and spec.kind == "action"):
            through = self._api == name or self._issued[-1] == self._sends[name]
            helped = self._api in self._sends and self._sends[self._api] is None
            past = self._origin == "plan" or (self._origin == "function" and helped)
            return through or (past and bool(truth.get(name, False)))
        function = self._functions[name]
        parameters = inspect.signature(function).parameters.values()
        if self._origin == "plan" and not parameters and name in truth:
            return truth[name]
        given = {p.name: self._supplied(p.name) for p in parameters if p.default is p.empty}
        if None in given.values():
            return None
        value = function(**given)
        return value if isinstance(value, (bool, float)) else None

    def _supplied(self, parameter: str) -> Any:
        points = [issued.arguments[0][1] for issued in self._issued]
        if parameter in self.platform.history_names:
            return points
        if parameter in self.platform.current_names:
            return points[-1]
        return points[max(len(points) - 2, 0)] if self._is_previous(parameter) else None

    def _is_previous(self, parameter: str) -> bool:
        return parameter in self.platform.previous_names

    # --- limits --------------------------------------------------------------------------------

    def _watched(self, run: Callable[[], None]) -> None:
        """Run, counting lines, so that a loop without a command comes to an end."""

        def local(frame: types.FrameType, event: str, argument: Any) -> Any:
            self._lines += event == "line"
            if self._lines > LINES:
                raise TooLongError
            return local

        def opened(frame: types.FrameType, event: str, argument: Any) -> Any:
            return local if frame.f_code.co_filename == "<plan>" else None

        before = sys.gettrace()
        sys.settrace(opened)
        try:
            run()
        finally:
            sys.settrace(before)
