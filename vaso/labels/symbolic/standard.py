"""Python's own functions, on values that may not be known."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any, Protocol

import z3

from vaso.labels.symbolic import mathematics
from vaso.labels.symbolic.history import History
from vaso.labels.symbolic.mathematics import binary
from vaso.labels.symbolic.paths import Path
from vaso.labels.symbolic.values import Class, NotUnderstoodError, Record, Value, is_term, real

__all__ = ["BUILT_IN", "CALLABLE"]


class Runs(Protocol):
    """The interpreter, as far as these functions need it."""

    path: Path

    def items(self, value: Value) -> list[Value]:
        """The items of something that can be gone through."""
        ...

    def truth(self, value: Value) -> Value:
        """The truth value of a value."""
        ...


def _length(run: Runs, value: Value) -> Value:
    if isinstance(value, History):
        return value.length
    if isinstance(value, list | tuple | str | dict):
        return len(value)
    raise NotUnderstoodError("the length of something that is not known")


def _extreme(op: ast.cmpop) -> Callable[..., Value]:
    def of(run: Runs, *values: Value) -> Value:
        parts = run.items(values[0]) if len(values) == 1 else list(values)
        return mathematics.extreme(op, parts)

    return of


def _all(run: Runs, values: Value) -> Value:
    return all(run.path.decide(run.truth(v)) for v in run.items(values))


def _any(run: Runs, values: Value) -> Value:
    return any(run.path.decide(run.truth(v)) for v in run.items(values))


def _is_instance(run: Runs, value: Value, kind: Value) -> Value:
    kinds = kind if isinstance(kind, tuple) else (kind,)
    if isinstance(value, z3.BoolRef):
        return "bool" in kinds or "int" in kinds
    if is_term(value):
        if "float" in kinds:
            return True
        raise NotUnderstoodError("whether a number is whole")
    names = [c.__name__ for c in type(value).__mro__]
    if isinstance(value, Record):
        names = [value.kind.name]
    if any(not isinstance(k, str) and not isinstance(k, Class) for k in kinds):
        raise NotUnderstoodError("isinstance with an unusual class")
    return any((k.name if isinstance(k, Class) else k) in names for k in kinds)


def _float(run: Runs, value: Value) -> Value:
    return real(value) if is_term(value) else mathematics.call_plain(float, [value])


def _plain(function: Any) -> Callable[..., Value]:
    return lambda run, *args: mathematics.call_plain(function, args)


def _range(run: Runs, *bounds: Value) -> Value:
    if any(type(b) is not int for b in bounds):
        raise NotUnderstoodError("a range that is not known")
    return range(*bounds)


CALLABLE: dict[str, Callable[..., Value]] = {
    "abs": lambda run, value: mathematics.absolute(value),
    "min": _extreme(ast.Lt()),
    "max": _extreme(ast.Gt()),
    "sum": lambda run, values, start=0: mathematics.total(values, run.path, start),
    "len": _length,
    "all": _all,
    "any": _any,
    "round": lambda run, *args, **kwargs: mathematics.rounded(*args, *kwargs.values()),
    "pow": lambda run, base, exponent: binary(ast.Pow(), base, exponent, run.path),
    "float": _float,
    "int": _plain(int),
    "bool": lambda run, value: run.truth(value),
    "isinstance": _is_instance,
    "range": _range,
    "tuple": lambda run, values=(): tuple(run.items(values)),
    "list": lambda run, values=(): run.items(values) if not isinstance(values, History) else values,
    "zip": lambda run, *lists: [tuple(z) for z in zip(*map(run.items, lists), strict=False)],
    "enumerate": lambda run, values, start=0: list(enumerate(run.items(values), start)),
    "reversed": lambda run, values: run.items(values)[::-1],
    "print": lambda run, *values, **_: None,
}
BUILT_IN = frozenset(CALLABLE) | {"str", "dict", "object"}
"""Names that stand for themselves; a name that the code binds goes before."""
