"""Values of the symbolic interpreter: Python's own, z3 terms over the reals, and simple objects."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, TypeAlias

import z3

__all__ = [
    "Bound",
    "Class",
    "Function",
    "NotUnderstoodError",
    "Poison",
    "PythonError",
    "Record",
    "Value",
    "compare",
    "equal",
    "is_symbolic",
    "is_term",
    "number",
    "real",
]

Value: TypeAlias = Any
"""A Python value, a z3 term, or one of the classes below."""


class NotUnderstoodError(Exception):
    """Code that the interpreter has no meaning for; whatever depends on it is not proved."""


class PythonError(Exception):
    """The interpreted program raises an exception."""


@dataclass(frozen=True, eq=False)
class Function:
    """A function with the names around it.

    Attributes:
        node: Its definition.
        outer: Local variables of the functions around it.
        names: Finds a global name.
        defaults: Values of its last parameters; None where only constants are meant.
    """

    node: ast.FunctionDef | ast.Lambda
    outer: Mapping[str, Value]
    names: Any
    defaults: tuple[Value, ...] | None = None


@dataclass(frozen=True, eq=False)
class Bound:
    """A method of an object, or anything else that the interpreter calls by itself."""

    call: Callable[[list[Value], dict[str, Value]], Value]


@dataclass(frozen=True, eq=False)
class Class:
    """A class: its fields with defaults, in order, and its methods."""

    name: str
    fields: Mapping[str, Value]
    methods: Mapping[str, Function]
    static: frozenset[str] = frozenset()
    generated: bool = True


@dataclass(eq=False)
class Record:
    """An object of a simple class."""

    kind: Class
    fields: dict[str, Value] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Poison:
    """A value that is not known; using it is not understood."""

    why: str


def is_term(value: Value) -> bool:
    """True for a z3 term."""
    return isinstance(value, z3.ExprRef)


def is_symbolic(value: Value) -> bool:
    """True for what is not a plain Python value through and through."""
    if isinstance(value, list | tuple):
        return any(map(is_symbolic, value))
    if isinstance(value, dict):
        return any(map(is_symbolic, value.values()))
    return not isinstance(value, bool | int | float | str | None | Function | Class | Bound)


def real(value: Value) -> Any:
    """A number as a term over the reals; decimals are taken as they are written."""
    if isinstance(value, z3.BoolRef):
        return z3.If(value, z3.RealVal(1), z3.RealVal(0))
    if is_term(value):
        return z3.ToReal(value) if value.is_int() else value
    if isinstance(value, bool | int | float) and math.isfinite(value):
        return z3.RealVal(Fraction(repr(float(value)) if isinstance(value, float) else int(value)))
    raise NotUnderstoodError(f"a number is needed, not {type(value).__name__}")


def number(value: Value) -> Value:
    """The value, if it is a number or a truth value."""
    if isinstance(value, bool | int | float | z3.ArithRef | z3.BoolRef):
        return value
    raise NotUnderstoodError(f"a number is needed, not {type(value).__name__}")


_COMPARE: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}


def compare(op: ast.cmpop, left: Value, right: Value) -> Value:
    """The truth of a comparison."""
    if isinstance(op, ast.Eq | ast.NotEq):
        found = equal(left, right)
        if isinstance(op, ast.Eq):
            return found
        return z3.Not(found) if is_term(found) else not found
    if isinstance(op, ast.Is | ast.IsNot):
        if is_term(left) or is_term(right):
            if left is not None and right is not None:
                raise NotUnderstoodError("'is' between numbers")
            return isinstance(op, ast.IsNot)
        return (left is right) == isinstance(op, ast.Is)
    if isinstance(op, ast.In | ast.NotIn):
        if is_symbolic(left) or is_symbolic(right):
            raise NotUnderstoodError("'in' with a value that is not known")
        return (left in right) == isinstance(op, ast.In)
    if is_term(left) or is_term(right):
        return _COMPARE[type(op)](real(left), real(right))
    if isinstance(left, bool | int | float) and isinstance(right, bool | int | float):
        return _COMPARE[type(op)](left, right)
    raise NotUnderstoodError("a comparison of something other than numbers")


def equal(left: Value, right: Value) -> Value:
    """Equality, of numbers, vectors and objects."""
    if is_term(left) or is_term(right):
        if isinstance(left, z3.BoolRef | bool) and isinstance(right, z3.BoolRef | bool):
            return _truth(left) == _truth(right)
        if left is None or right is None or isinstance(left, str) or isinstance(right, str):
            return False
        return real(left) == real(right)
    if isinstance(left, list | tuple) and isinstance(right, list | tuple):
        if type(left) is not type(right) or len(left) != len(right):
            return False
        return conjunction([equal(a, b) for a, b in zip(left, right, strict=True)])
    if isinstance(left, Record) and isinstance(right, Record):
        if left.kind.name != right.kind.name or left.fields.keys() != right.fields.keys():
            return False
        return conjunction([equal(v, right.fields[n]) for n, v in left.fields.items()])
    if is_symbolic(left) or is_symbolic(right):
        raise NotUnderstoodError("equality of values that are not known")
    return bool(left == right)


def conjunction(parts: list[Value]) -> Value:
    """All of some truths."""
    if any(p is False for p in parts):
        return False
    terms = [p for p in parts if p is not True]
    return z3.And(terms) if terms else True


def _truth(value: Value) -> Any:
    return z3.BoolVal(value) if isinstance(value, bool) else value
