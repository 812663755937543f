"""L(s): the value of every proposition in a control state."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

from vaso.errors import LabellingError
from vaso.plan.config import EPOCH, Clock, Config, Origin, Reader, Turn
from vaso.plan.labelling import ROWS, Commanded, Function, Labelling, Returned, Slept, Threw
from vaso.plan.machine import Continuation
from vaso.plan.trajectory import Histories
from vaso.plan.transition_system import Case, Label, Sensor
from vaso.platforms import Issued, Platform

REPEATS = (1, 2, 3, 10, 100)
"""How many more of the same set-point must leave the propositions as they are."""

CHUNK = 100
"""Set-points that are labelled in one request, so that no request runs for long."""

NANO = 9
"""Numeric labels are rounded to 1e-9, so that float drift does not decide a verdict."""


class Labeller:
    """Computes labels with the skill's labelling code, and the platform's truth for the rest.

    Args:
        labelling: The labelling code.
        platform: Its platform.
        histories: Set-point histories.
        needed: Propositions that some formula mentions; a failure to compute one is an error.
        at: The labelling code's first state, for finding out what each function is.
    """

    def __init__(
        self,
        labelling: Labelling,
        platform: Platform,
        histories: Histories,
        needed: Collection[str],
        at: Continuation,
    ) -> None:
        self.labelling = labelling
        self.platform = platform
        self._time = Clock(platform.dt)
        self.histories = histories
        self.sensors: dict[str, Sensor] = {}
        self.actions: dict[str, Issued | None] = {}
        self.values: dict[str, Function] = {}
        self._memo: dict[tuple[bytes, str, int, float], Label | tuple[Case, ...]] = {}
        rest = histories.start(platform.rest)
        for function in labelling.functions.values():
            self._classify(function, at, rest, function.name in needed)

    # --- what each function is -----------------------------------------------------------------

    def _classify(self, function: Function, at: Continuation, rest: int, needed: bool) -> None:
        name = function.name
        spec = self.platform.proposition(name)
        action = spec is not None and spec.kind == "action"
        if not needed and (name.startswith("_") or function.parameters):
            return
        if not function.readable:
            if action:
                self.actions[name] = None
            elif needed:
                raise self._unreadable(function)
            return
        outcome = self._read(function, at, rest, Reader({}), EPOCH)
        if isinstance(outcome, Commanded):
            self.actions[name] = self._alone(outcome)
        elif action or isinstance(outcome, Slept) or _is_none(outcome):
            self.actions[name] = None
        elif _is_label(outcome):
            self.values[name] = function
        elif needed:
            raise self._failed(function, outcome)

    def _alone(self, outcome: Commanded) -> Issued | None:
        """The command, if it is the only one that the function sends."""
        rest = self.labelling.resume(outcome.at, Reader({}).ask, EPOCH)
        return outcome.issued if isinstance(rest, (Returned, Threw)) else None

    def _unreadable(self, function: Function) -> LabellingError:
        supplied = [
            *self.platform.history_names,
            *self.platform.current_names,
            *self.platform.previous_names,
        ]
        error = self.labelling.error(
            f"the proposition '{function.name}' needs {', '.join(function.unknown)}, "
            f"which platform {self.platform.name} cannot supply",
            function.line,
        )
        error.expected = f"parameters named {', '.join(supplied)}" if supplied else "no parameters"
        return error

    def _failed(self, function: Function, outcome: Any) -> LabellingError:
        if isinstance(outcome, Threw):
            message = f"'{function.name}' raises {outcome.error}: {outcome.message}"
            return self.labelling.error(message, outcome.line or function.line)
        value = outcome.value if isinstance(outcome, Returned) else None
        return self.labelling.error(
            f"'{function.name}' returns {_short(value)}: neither a truth value nor a number",
            function.line,
        )

    # --- labels --------------------------------------------------------------------------------

    @property
    def names(self) -> set[str]:
        """Every proposition that a state is labelled with."""
        return {*self.actions, *self.values, *(p.name for p in self.platform.propositions)}

    def labels(self, here: Config) -> tuple[dict[str, Label], dict[str, tuple[Case, ...]]]:
        """Labels that do not depend on sensors, and those that do, by cases."""
        truth = self.platform.dynamics.truth(here.world)
        fixed: dict[str, Label] = {}
        observed: dict[str, tuple[Case, ...]] = {}
        for name in sorted(self.names):
            value = self._label(name, here, truth)
            if isinstance(value, tuple):
                observed[name] = value
            elif value is not None:
                fixed[name] = _rounded(value)
        return fixed, observed

    def _label(
        self, name: str, here: Config, truth: Mapping[str, Label]
    ) -> Label | tuple[Case, ...] | None:
        if name in self.actions:
            return self._action(name, here, truth)
        function = self.values.get(name)
        if function is not None:
            direct = here.origin is Origin.PLAN and not function.parameters
            return truth[name] if direct and name in truth else self._value(function, here)
        if name in truth:
            return truth[name]
        spec = self.platform.proposition(name)
        if spec is None or spec.sensor is None:
            return None
        sensor = self.sensors.setdefault(spec.sensor, Sensor(spec.sensor))
        return tuple(Case({sensor.name: v}, bool(v)) for v in sensor.domain)

    def _action(self, name: str, here: Config, truth: Mapping[str, Label]) -> bool:
        """Issued through the action's function, or equal to what that function sends."""
        if here.api == name or (here.issued == self.actions[name]):
            return True
        bypassed = here.origin in (Origin.PLAN, Origin.HELPER)
        return bypassed and bool(truth.get(name, False))

    def _value(self, function: Function, here: Config) -> Label | tuple[Case, ...]:
        at = self._idle(here)
        clock = self._time.at(here.tick) if self.labelling.uses_clock else EPOCH
        history = here.history if function.parameters else -1
        memo = (at.key, function.name, history, clock)
        if memo not in self._memo:
            self._memo[memo] = self._evaluate(function, at, here.history, clock)
        return self._memo[memo]

    def steady(self, here: Config) -> bool:
        """True when no proposition changes however often the set-point in force is repeated.

        The labelling code cannot be asked for all repetitions; it is asked for ``REPEATS``.
        """
        functions = [f for f in self.values.values() if f.parameters]
        longer, length = here.history, 0
        for repeats in REPEATS if functions else ():
            while length < repeats:
                longer, length = self.histories.extend(longer, here.issued), length + 1
            after = replace(here, history=longer)
            if any(self._value(f, after) != self._value(f, here) for f in functions):
                return False
        return True

    def _idle(self, here: Config) -> Continuation:
        if here.turn is not Turn.LABELLING:
            return here.lab
        return self.labelling.abandon(here.lab, Reader({}).ask, EPOCH)

    def _evaluate(
        self, function: Function, at: Continuation, history: int, clock: float
    ) -> Label | tuple[Case, ...]:
        """Call a proposition's function under every sensor reading that it looks at."""
        cases: list[Case] = []
        todo: list[dict[str, Any]] = [{}]
        while todo:
            reader = Reader(todo.pop())
            outcome = self._read(function, at, history, reader, clock)
            if isinstance(outcome, Commanded):
                raise self.labelling.error(
                    f"'{function.name}' sends {outcome.issued} when it is read as a proposition",
                    function.line,
                )
            if not _is_label(outcome):
                raise self._failed(function, outcome)
            cases.append(Case(reader.valuation, _rounded(outcome.value)))
            todo += reader.alternatives
            for name, domain in reader.domains.items():
                self.sensors.setdefault(name, Sensor(name, tuple(domain)))
        return cases[0].value if len(cases) == 1 and not cases[0].guard else tuple(cases)

    def _read(
        self, function: Function, at: Continuation, history: int, reader: Reader, clock: float
    ) -> Any:
        points: list[Any] = self.histories.points(history) or [None]
        supply: dict[str, Any] = {"history": points, "current": points[-1]}
        supply["previous"] = points[-2] if len(points) > 1 else points[-1]
        kwargs = {parameter: supply[kind] for parameter, kind in function.parameters}
        return self.labelling.request(at, function.name, (), kwargs, reader.ask, clock)

    def prefill(self, here: Config, histories: list[int]) -> None:
        """Evaluate trajectory propositions along a whole trajectory in a few requests.

        Args:
            here: The configuration that starts the trajectory.
            histories: Histories along it, each one set-point longer than the one before.
        """
        calls = [(f.name, list(f.parameters)) for f in self.values.values() if f.parameters]
        if not calls or self.labelling.uses_clock:
            return
        at = self._idle(here)
        points = self.histories.points(histories[-1])
        first = len(points) - len(histories)
        for start in range(0, len(histories), CHUNK):
            part = histories[start : start + CHUNK]
            bounds = (first + start + 1, first + start + len(part) + 1)
            if not self._fill(at, calls, points, bounds, part):
                return

    def _fill(
        self,
        at: Continuation,
        calls: list[tuple[str, list[tuple[str, str]]]],
        points: list[Any],
        bounds: tuple[int, int],
        histories: list[int],
    ) -> bool:
        """Fill the memo for some histories; False if that has to be done one by one."""

        def refuse(sensor: str, domain: Any) -> Any:
            raise LabellingError("a trajectory proposition reads a sensor")

        try:
            outcome = self.labelling.request(at, ROWS, (calls, points, *bounds), {}, refuse, EPOCH)
        except LabellingError:
            return False
        if not isinstance(outcome, Returned) or outcome.at.key != at.key:
            return False
        for history, row in zip(histories, outcome.value, strict=True):
            for (name, _), value in zip(calls, row, strict=True):
                if _finite(value):
                    self._memo[(at.key, name, history, EPOCH)] = _rounded(value)
        return True


def _short(value: object, width: int = 60) -> str:
    text = repr(value)
    return text if len(text) <= width else f"{text[:width]}…"


def _is_none(outcome: Any) -> bool:
    return isinstance(outcome, Returned) and outcome.value is None


def _is_label(outcome: Any) -> bool:
    return isinstance(outcome, Returned) and _finite(outcome.value)


def _finite(value: object) -> bool:
    try:
        return isinstance(value, bool | int | float) and math.isfinite(value)
    except OverflowError:
        return False


def _rounded(value: Label) -> Label:
    return value if isinstance(value, bool) else round(float(value), NANO)
