"""The platform's dynamics, translated: its own Python code run on values that are not known."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import z3

from vaso.labels.symbolic.interpreter import Interpreter
from vaso.labels.symbolic.names import ISSUED, issued_record, object_record, plain
from vaso.labels.symbolic.paths import Path
from vaso.labels.symbolic.values import NotUnderstoodError, Record, Value
from vaso.platforms import Command, Platform

__all__ = ["World", "parts", "unknown_command"]


class World:
    """The dynamics of a platform.

    Args:
        platform: The platform.

    Raises:
        NotUnderstoodError: Its dynamics are not plain Python.
    """

    def __init__(self, platform: Platform) -> None:
        self._dynamics = object_record(platform.dynamics)
        self._several = len(platform.commands) > 1
        self.initial = plain(platform.dynamics.initial())

    def unknown(self, path: Path) -> Value:
        """A state of the dynamics that nothing is known about."""
        if self._several and _has_command(self.initial):
            raise NotUnderstoodError("dynamics that remember which command it was")
        return _unknown(self.initial, path, "world")

    def step(self, path: Path, state: Value, command: Value) -> Value:
        """The state at the end of a period."""
        return self._call(path, "step", [state, command])

    def truth(self, path: Path, state: Value) -> dict[str, Value]:
        """The true propositions of a state."""
        found = self._call(path, "truth", [state])
        if not isinstance(found, dict):
            raise NotUnderstoodError("dynamics without true propositions")
        return found

    def _call(self, path: Path, name: str, args: list[Value]) -> Value:
        method = self._dynamics.kind.methods.get(name)
        if method is None:
            raise NotUnderstoodError(f"dynamics without {name}")
        before = dict(self._dynamics.fields)
        result = Interpreter(path).call(method, [self._dynamics, *args], {})
        if any(self._dynamics.fields.get(n) is not v for n, v in before.items()):
            raise NotUnderstoodError("dynamics that change themselves")
        return result


def _has_command(state: Value) -> bool:
    if isinstance(state, tuple):
        return any(map(_has_command, state))
    if isinstance(state, Record):
        return state.kind is ISSUED or any(map(_has_command, state.fields.values()))
    return False


def _unknown(like: Value, path: Path, name: str) -> Value:
    """A value of the same shape of which nothing is known."""
    if isinstance(like, bool):
        return path.fresh(name, "bool")
    if isinstance(like, int | float):
        return path.fresh(name)
    if isinstance(like, tuple):
        return tuple(_unknown(v, path, name) for v in like)
    if isinstance(like, Record) and like.kind is ISSUED:
        arguments = {n: _unknown(v, path, n) for n, v in like.fields["arguments"]}
        return issued_record(like.fields["name"], arguments)
    if isinstance(like, Record):
        return Record(like.kind, {n: _unknown(v, path, n) for n, v in like.fields.items()})
    raise NotUnderstoodError("dynamics with a state that is not made of numbers")


def unknown_command(command: Command, path: Path) -> Record:
    """A command with arguments that nothing is known about."""
    arguments = {
        p.name: path.fresh(p.name)
        if p.size is None
        else tuple(path.fresh(f"{p.name}{i}") for i in range(p.size))
        for p in command.parameters
    }
    return issued_record(command.name, arguments)


def parts(value: Value) -> Iterator[Any]:
    """The numbers and truth values that a state is made of."""
    if isinstance(value, Record):
        for one in value.fields.values():
            yield from parts(one)
    elif isinstance(value, tuple):
        for one in value:
            yield from parts(one)
    elif isinstance(value, bool | int | float | z3.ExprRef):
        yield value
