"""Intervals: what is known of a number that is not known exactly (Moore, Interval Analysis, 1966).

Comparisons round both sides to nine decimals, as :func:`vaso.ltl.numbers.compare` does, so that a
bound that is off by rounding errors of the machine does not decide.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TypeAlias

from vaso.ltl import Arithmetic, Comparison, Number, Term, Variable
from vaso.ltl.numbers import DECIMALS
from vaso.ltl.traverse import fold_term

__all__ = ["EVERYTHING", "ZERO", "Interval", "compared", "enclose", "hull", "inside", "widened"]

Interval: TypeAlias = tuple[float, float]
"""Least and greatest value; either may be infinite."""

EVERYTHING: Interval = (-math.inf, math.inf)
ZERO: Interval = (0.0, 0.0)
SLACK = 1e-14
"""Relative error that computed bounds are widened by: some hundred roundings of a float."""


def hull(intervals: Iterable[Interval]) -> Interval:
    """The smallest interval around some intervals."""
    lows, highs = zip(*intervals, strict=True)
    return min(lows), max(highs)


def inside(inner: Interval, outer: Interval) -> bool:
    """True when every value of one interval is in another."""
    return outer[0] <= inner[0] and inner[1] <= outer[1]


def widened(interval: Interval) -> Interval:
    """An interval with room for the rounding errors of the machine."""
    low, high = interval
    return low - SLACK * (1.0 + abs(low)), high + SLACK * (1.0 + abs(high))


def enclose(term: Term, values: Mapping[str, Interval]) -> Interval:
    """The values that a term can have.

    Args:
        term: The term.
        values: What is known of each variable.
    """

    def combine(node: Term, parts: tuple[Interval, ...]) -> Interval:
        match node:
            case Number(value):
                return value, value
            case Variable(name):
                return values[name]
            case Arithmetic(op, _, _):
                return _combine(op, *parts)

    return fold_term(term, combine)


def _combine(op: str, left: Interval, right: Interval) -> Interval:
    if op == "+":
        return left[0] + right[0], left[1] + right[1]
    if op == "-":
        return left[0] - right[1], left[1] - right[0]
    if op == "/":
        if right[0] <= 0.0 <= right[1]:
            return EVERYTHING
        right = (1.0 / right[1], 1.0 / right[0])
    corners = [a * b for a in left for b in right]
    return EVERYTHING if any(map(math.isnan, corners)) else (min(corners), max(corners))


def compared(comparison: Comparison, values: Mapping[str, Interval]) -> bool | None:
    """Whether a comparison holds for all values (True), for none (False), or it depends (None)."""
    left, right = (_rounded(enclose(side, values)) for side in (comparison.left, comparison.right))
    if any(map(math.isnan, (*left, *right))):
        return None
    below, not_above = left[1] < right[0], left[1] <= right[0]
    above, not_below = left[0] > right[1], left[0] >= right[1]
    same = left == right and left[0] == left[1]
    yes, no = {
        "<": (below, not_below),
        "<=": (not_above, above),
        ">": (above, not_above),
        ">=": (not_below, below),
        "==": (same, below or above),
        "!=": (below or above, same),
    }[comparison.op]
    return True if yes else False if no else None


def _rounded(interval: Interval) -> Interval:
    return round(interval[0], DECIMALS), round(interval[1], DECIMALS)
