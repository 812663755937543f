"""The value of terms and comparisons in one step.

Both sides of a comparison are rounded to nine decimals before they are compared. Every part of
VASO that turns a comparison into a truth value uses :func:`compare`, so that they cannot disagree.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence

from vaso.errors import FormulaError
from vaso.ltl.syntax import Arithmetic, Comparison, Number, Term, Variable
from vaso.ltl.traverse import fold_term

__all__ = ["DECIMALS", "compare", "truths", "value_of"]

DECIMALS = 9
"""Decimals to which both sides of a comparison are rounded."""

_COMPARE: Mapping[str, Callable[[float, float], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}
_CALCULATE: Mapping[str, Callable[[float, float], float]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}


def compare(comparison: Comparison, step: Mapping[str, bool | float]) -> bool:
    """Tell whether a comparison holds in a step.

    Args:
        comparison: The comparison.
        step: The value of every proposition.

    Raises:
        FormulaError: A variable has no numeric value, a value is not finite, or a term divides by
            zero.
    """
    left, right = (_finite(term, comparison, step) for term in (comparison.left, comparison.right))
    return _COMPARE[comparison.op](round(left, DECIMALS), round(right, DECIMALS))


def truths(comparison: Comparison, steps: Sequence[Mapping[str, bool | float]]) -> list[bool]:
    """Tell in which of many steps a comparison holds; the same as :func:`compare`, but quicker.

    Args:
        comparison: The comparison.
        steps: For each step, the value of every proposition.

    Raises:
        FormulaError: As :func:`compare`.
    """
    left, right = comparison.left, comparison.right
    if isinstance(left, Variable) and isinstance(right, Number):
        values = [step.get(left.name) for step in steps]
        if all(type(value) is float and math.isfinite(value) for value in values):
            bound, holds = round(right.value, DECIMALS), _COMPARE[comparison.op]
            return [holds(round(value, DECIMALS), bound) for value in values if value is not None]
    return [compare(comparison, step) for step in steps]


def value_of(term: Term, step: Mapping[str, bool | float]) -> float:
    """Return the value of a term in a step, unrounded.

    Args:
        term: The term.
        step: The value of every proposition.

    Raises:
        FormulaError: A variable has no numeric value, or the term divides by zero.
    """
    if isinstance(term, Number):  # nearly every term is one of these two
        return term.value
    if isinstance(term, Variable):
        return _number(term.name, step)

    def combine(node: Term, parts: tuple[float, ...]) -> float:
        match node:
            case Number(value):
                return value
            case Variable(name):
                return _number(name, step)
            case Arithmetic(op, _, right):
                if op == "/" and round(parts[1], DECIMALS) == 0:
                    raise FormulaError(f"{node} divides by zero, because {right} is 0 in this step")
                return _CALCULATE[op](*parts)

    return fold_term(term, combine)


def _number(name: str, step: Mapping[str, bool | float]) -> float:
    if name not in step:
        available = ", ".join(sorted(step)) or "none"
        raise FormulaError(
            f"the numeric proposition {name} has no value in this step",
            hint=f"available: {available}",
        )
    value = step[name]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise FormulaError(f"{name} has the value {value!r}", expected="a number")
    try:
        return float(value)
    except OverflowError:
        raise FormulaError(f"the value of {name} is too large", expected="a number") from None


def _finite(term: Term, comparison: Comparison, step: Mapping[str, bool | float]) -> float:
    value = value_of(term, step)
    if not math.isfinite(value):
        raise FormulaError(
            f"{comparison} cannot be decided, because {term} is {value}", expected="a finite number"
        )
    return value
