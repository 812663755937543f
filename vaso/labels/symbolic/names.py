"""Global names: those of labelling code, and those of the module that defines a platform."""

from __future__ import annotations

import ast
import dataclasses
import inspect
import math
import textwrap
from collections.abc import Mapping
from types import FunctionType, ModuleType
from typing import Any

from vaso.labels.symbolic.classes import class_of
from vaso.labels.symbolic.expressions import Module
from vaso.labels.symbolic.history import Tail
from vaso.labels.symbolic.standard import BUILT_IN
from vaso.labels.symbolic.values import (
    Bound,
    Class,
    Function,
    NotUnderstoodError,
    PythonError,
    Record,
    Value,
)
from vaso.platforms import Issued

__all__ = ["ISSUED", "CodeNames", "RuntimeNames", "issued_record", "object_record"]


class CodeNames:
    """The global names of labelling code.

    Args:
        given: Names that it uses without defining them: commands, sensors, modules.
    """

    def __init__(self, given: Mapping[str, Value]) -> None:
        self.found: dict[str, Value] = {}
        self.given = given
        self.written: set[str] = set()

    def read(self, name: str) -> Value:
        """The value of a name."""
        for where in (self.found, self.given):
            if name in where:
                return where[name]
        if name in BUILT_IN:
            return name
        raise NotUnderstoodError(f"the name {name}")

    def write(self, name: str, value: Value) -> None:
        """Bind a name from within a function."""
        self.written.add(name)
        self.found[name] = value

    def shared(self) -> list[Value]:
        """Objects that outlive a call, and that calls could change."""
        found: list[Value] = []
        todo = list(self.found.values())
        while todo:
            value = todo.pop()
            if isinstance(value, list | tuple):
                todo += value
            elif isinstance(value, dict):
                todo += value.values()
            elif isinstance(value, Record):
                todo += value.fields.values()
            if isinstance(value, list | dict | Record | Tail):
                found.append(value)
        return found


class RuntimeNames:
    """The global names of a Python module that runs outside the sandbox: a platform's.

    Args:
        module: Its namespace.
    """

    def __init__(self, module: Mapping[str, Any]) -> None:
        self._module = module
        self._known: dict[str, Value] = {}

    def read(self, name: str) -> Value:
        """The value of a name."""
        if name not in self._known:
            if name not in self._module:
                if name in BUILT_IN:
                    return name
                raise NotUnderstoodError(f"the name {name}")
            self._known[name] = self._value(self._module[name])
        return self._known[name]

    def write(self, name: str, value: Value) -> None:
        """Refuse to bind a name."""
        raise NotUnderstoodError("a platform with variables of its own")

    def shared(self) -> list[Value]:
        """Objects that calls must not change."""
        return list(self._known.values())

    def _value(self, value: Any) -> Value:
        if isinstance(value, FunctionType):
            return Function(_definition(value), {}, RuntimeNames(value.__globals__))
        if isinstance(value, type):
            return class_of(_class_definition(value), self)
        if value is math:
            return Module()
        if isinstance(value, ModuleType):
            raise NotUnderstoodError("a module")
        return plain(value)


def plain(value: Any) -> Value:
    """A value of the running program for the interpreter."""
    if isinstance(value, bool | int | float | str | None):
        return value
    if isinstance(value, tuple):
        return tuple(map(plain, value))
    if isinstance(value, Issued):
        return issued_record(value.name, {n: plain(v) for n, v in value.arguments})
    return object_record(value)


def object_record(value: Any) -> Record:
    """An object of a simple class of the running program, with its methods.

    Raises:
        NotUnderstoodError: The class is not that simple.
    """
    kind = type(value)
    try:
        namespace = vars(inspect.getmodule(kind))
    except TypeError as error:
        raise NotUnderstoodError("a class without a module") from error
    known = class_of(_class_definition(kind), RuntimeNames(namespace))
    if dataclasses.is_dataclass(value):
        fields = {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
    else:
        fields = dict(getattr(value, "__dict__", {}))
    return Record(known, {name: plain(v) for name, v in fields.items()})


def _definition(function: FunctionType) -> ast.FunctionDef:
    node = _source(function).body[0]
    if not isinstance(node, ast.FunctionDef) or node.decorator_list or function.__closure__:
        raise NotUnderstoodError("a function that is not plain")
    return node


def _class_definition(kind: type) -> ast.ClassDef:
    node = _source(kind).body[0]
    if not isinstance(node, ast.ClassDef):
        raise NotUnderstoodError("a class that is not plain")
    return node


def _source(thing: Any) -> ast.Module:
    try:
        return ast.parse(textwrap.dedent(inspect.getsource(thing)))
    except (OSError, TypeError, SyntaxError) as error:
        raise NotUnderstoodError("code whose text is not known") from error


# -- commands --------------------------------------------------------------------------------------


def _argument(args: list[Value], kwargs: dict[str, Value]) -> Value:
    owner, name = args
    found = dict(owner.fields["arguments"])
    if name not in found:
        raise PythonError("KeyError: no such argument")
    return found[name]


ISSUED = Class("Issued", {"name": None, "arguments": None}, {"__getitem__": Bound(_argument)})  # type: ignore[dict-item]
"""The class of a command as it goes out."""


def issued_record(name: str, arguments: Mapping[str, Value]) -> Record:
    """A command as the interpreter sees it."""
    return Record(ISSUED, {"name": name, "arguments": tuple(arguments.items())})
