"""Operators and functions on numbers that may not be known."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Sequence
from typing import Any

import z3

from vaso.labels.symbolic.paths import Path
from vaso.labels.symbolic.values import (
    NotUnderstoodError,
    PythonError,
    Value,
    compare,
    is_symbolic,
    is_term,
    number,
    real,
)

__all__ = ["MATH", "binary", "call_plain", "negative"]

EXACT_DECIMALS = 6
"""Rounding to so many decimals or more is taken as exact: proofs are over the reals."""
LARGEST_POWER = 4

_PLAIN: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
}


def binary(op: ast.operator, left: Value, right: Value, path: Path) -> Value:
    """The value of ``left op right``."""
    if not is_term(left) and not is_term(right):
        if is_symbolic(left) or is_symbolic(right):
            return _sequences(op, left, right)
        return call_plain(_PLAIN.get(type(op)), [left, right])
    if isinstance(op, ast.Pow):
        return _power(left, right, path)
    a, b = real(left), real(right)
    match op:
        case ast.Add():
            return a + b
        case ast.Sub():
            return a - b
        case ast.Mult():
            return a * b
        case ast.Div():
            if not path.decide(b != 0):
                raise PythonError("ZeroDivisionError: division by zero")
            return a / b
    raise NotUnderstoodError(f"the operator {type(op).__name__} on numbers that are not known")


def _sequences(op: ast.operator, left: Value, right: Value) -> Value:
    same = type(left) is type(right) and isinstance(left, list | tuple)
    if isinstance(op, ast.Add) and same:
        return left + right
    if isinstance(op, ast.Mult) and isinstance(left, list | tuple) and type(right) is int:
        return left * right
    raise NotUnderstoodError("an operator on values that are not numbers")


def _power(base: Value, exponent: Value, path: Path) -> Value:
    if exponent == 0.5 and not is_term(exponent):
        return root(base, path)
    if is_term(exponent) or exponent != int(exponent) or not 0 <= exponent <= LARGEST_POWER:
        raise NotUnderstoodError("a power other than a small whole one")
    found: Any = z3.RealVal(1)
    for _ in range(int(exponent)):
        found = found * real(base)
    return found


def negative(value: Value) -> Value:
    """The value with its sign turned."""
    return -real(value) if is_term(value) else -number(value)


def root(value: Value, path: Path) -> Value:
    """The square root."""
    if not is_term(value):
        return call_plain(math.sqrt, [value])
    if not path.decide(real(value) >= 0):
        raise PythonError("ValueError: math domain error")
    return path.root(real(value))


def absolute(value: Value) -> Value:
    """The absolute value."""
    if not is_term(value):
        return abs(number(value))
    term = real(value)
    return z3.If(term >= 0, term, -term)


def extreme(op: ast.cmpop, values: Sequence[Value]) -> Value:
    """The least or the greatest of some numbers."""
    if not values:
        raise PythonError("ValueError: an empty sequence")
    best = number(values[0])
    for value in values[1:]:
        better = compare(op, number(value), best)
        if is_term(better):
            best = z3.If(better, real(value), real(best))
        elif better:
            best = value
    return best


def length(vector: Sequence[Value], path: Path) -> Value:
    """The Euclidean length of a vector."""
    if not is_symbolic(list(vector)):
        return call_plain(math.hypot, list(vector))
    total: Any = z3.RealVal(0)
    for part in vector:
        total = total + real(part) * real(part)
    return path.root(total)


def distance(start: Value, end: Value, path: Path) -> Value:
    """The Euclidean distance of two points."""
    if not isinstance(start, list | tuple) or not isinstance(end, list | tuple):
        raise NotUnderstoodError("math.dist of something other than points")
    if len(start) != len(end):
        raise PythonError("ValueError: points of different dimension")
    minus = ast.Sub()
    return length([binary(minus, a, b, path) for a, b in zip(start, end, strict=True)], path)


def rounded(value: Value, decimals: Value = None) -> Value:
    """The value rounded; to many decimals, it is the value."""
    if not is_term(value):
        return call_plain(round, [value] if decimals is None else [value, decimals])
    if type(decimals) is not int or decimals < EXACT_DECIMALS:
        raise NotUnderstoodError(f"rounding to fewer than {EXACT_DECIMALS} decimals")
    return value


def call_plain(function: Any, arguments: Sequence[Value]) -> Value:
    """Call one of Python's own functions on known values."""
    if function is None or any(map(is_symbolic, arguments)):
        raise NotUnderstoodError("a function of Python on values that are not known")
    try:
        return function(*arguments)
    except (ArithmeticError, ValueError, TypeError, IndexError, KeyError) as error:
        raise PythonError(f"{type(error).__name__}: {error}") from error


def _fabs(path: Path, value: Value) -> Value:
    return absolute(value)


MATH: dict[str, Callable[..., Value]] = {
    "sqrt": lambda path, value: root(value, path),
    "hypot": lambda path, *vector: length(vector, path),
    "dist": lambda path, start, end: distance(start, end, path),
    "pow": lambda path, base, exponent: binary(ast.Pow(), base, exponent, path),
    "fabs": _fabs,
    "fsum": lambda path, values: total(values, path),
}
"""Functions of the module math that are understood."""


def total(values: Value, path: Path, start: Value = 0) -> Value:
    """The sum of some numbers."""
    if not isinstance(values, list | tuple):
        raise NotUnderstoodError("a sum over something other than a list")
    for value in values:
        start = binary(ast.Add(), start, value, path)
    return start
