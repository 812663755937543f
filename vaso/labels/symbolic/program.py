"""Labelling code in the symbolic interpreter: load it, call it, know what it did."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import z3

from vaso.labels.symbolic.expressions import Module
from vaso.labels.symbolic.interpreter import Interpreter, LoopHook
from vaso.labels.symbolic.names import CodeNames, issued_record
from vaso.labels.symbolic.paths import Path
from vaso.labels.symbolic.values import (
    Bound,
    Function,
    NotUnderstoodError,
    Poison,
    PythonError,
    Record,
    Value,
    number,
)
from vaso.plan.transition_system import Scalar
from vaso.platforms import Command, Platform, SensorSpec

__all__ = ["Program", "Sent"]


@dataclass
class Sent:
    """A command that the code has sent.

    Attributes:
        issued: The command.
        found: The global names at that moment.
        last: False where the code goes on to read a sensor or to send another command.
    """

    issued: Record
    found: dict[str, Value]
    last: bool = True


@dataclass
class Program:
    """Labelling code on one path.

    Attributes:
        tree: The code.
        platform: Its platform.
        path: Decides what is not known.
        loop: Runs loops over set-points.
    """

    tree: ast.Module
    platform: Platform
    path: Path
    loop: LoopHook | None = None
    senses: dict[str, Scalar] = field(default_factory=dict)
    sent: list[Sent] = field(default_factory=list)

    def __post_init__(self) -> None:
        given: dict[str, Value] = {"math": Module()}
        given |= {c.name: self._command(c) for c in self.platform.commands}
        given |= {s.name: self._sensor(s) for s in self.platform.sensors}
        self.names = CodeNames(given)
        self.run = Interpreter(self.path, self.loop)
        self.run.run_module([n for n in self.tree.body if not _is_alias(n)], self.names)
        if self.sent or self.senses:
            raise NotUnderstoodError("code that acts while it is loaded")
        self.names.written.clear()

    def forget(self) -> None:
        """Let every variable that some function changes have any value of its type."""
        changed = {n for g in ast.walk(self.tree) if isinstance(g, ast.Global) for n in g.names}
        for name in sorted(changed):
            self.names.found[name] = self._any(name, self.names.found.get(name))

    def _any(self, name: str, value: Value) -> Value:
        if isinstance(value, bool | z3.BoolRef):
            return self.path.fresh(name, "bool")
        if isinstance(value, int | float | z3.ArithRef):
            return self.path.fresh(name)
        return Poison(f"the variable {name}")

    def call(
        self, name: str, args: list[Value], kwargs: Mapping[str, Value] | None = None
    ) -> Value:
        """Call a function of the code."""
        function = self.names.read(name)
        if not isinstance(function, Function):
            raise NotUnderstoodError(f"{name} is no plain function")
        return self.run.call(function, args, dict(kwargs or {}))

    def label(self, name: str, kwargs: Mapping[str, Value], found: dict[str, Value]) -> Value:
        """The value of a label's function where global names have some values, in a new state.

        Raises:
            NotUnderstoodError: It changes something, or sends a command.
        """
        before, sent = self.names.found, len(self.sent)
        self.names.found = dict(found)
        try:
            value = self.call(name, [], kwargs)
            after = self.names.found
            if after.keys() != found.keys() or any(after[n] is not v for n, v in found.items()):
                raise NotUnderstoodError("a label that changes a variable")
        finally:
            self.names.found = before
        if len(self.sent) != sent:
            raise NotUnderstoodError("a label that sends a command")
        return value

    # -- what the code calls -----------------------------------------------------------------------

    def _command(self, command: Command) -> Bound:
        def send(args: list[Value], kwargs: dict[str, Value]) -> None:
            arguments = _arguments(command, args, kwargs)
            if self.sent:
                self.sent[-1].last = False
            self.sent.append(Sent(issued_record(command.name, arguments), dict(self.names.found)))

        return Bound(send)

    def _sensor(self, sensor: SensorSpec) -> Bound:
        def read(args: list[Value], kwargs: dict[str, Value]) -> Value:
            if any(not isinstance(a, str | int | float) for a in (*args, *kwargs.values())):
                raise NotUnderstoodError("a sensor with an argument that is not known")
            if self.sent:
                self.sent[-1].last = False
            return self.reading(sensor.key(args, kwargs), sensor.domain)

        return Bound(read)

    def reading(self, key: str, domain: tuple[Scalar, ...]) -> Scalar:
        """The value of a sensor in this state: each of its domain, on a path of its own."""
        if key not in self.senses:
            self.senses[key] = domain[self.path.choose(len(domain))]
        return self.senses[key]


def _arguments(command: Command, args: list[Value], kwargs: dict[str, Value]) -> dict[str, Value]:
    names = [p.name for p in command.parameters]
    if len(args) > len(names) or not kwargs.keys() <= set(names):
        raise PythonError("TypeError: wrong arguments")
    given = dict(zip(names, args, strict=False)) | kwargs
    found: dict[str, Value] = {}
    for parameter in command.parameters:
        value = given.get(parameter.name, parameter.default)
        if parameter.size is None:
            found[parameter.name] = number(value)
        elif isinstance(value, list | tuple) and len(value) == parameter.size:
            found[parameter.name] = tuple(map(number, value))
        else:
            raise NotUnderstoodError("a command with an argument that is no vector")
    return found


def _is_alias(node: ast.stmt) -> bool:
    """True for ``Velocity = Tuple[float, float, float]``."""
    value: Any = getattr(node, "value", None)
    return isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(value, ast.Subscript)
