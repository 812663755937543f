"""Formula progression: what is left of a formula after a step.

What must hold from the next step on is a *positive boolean combination of formulas*, kept as its
minimal disjunctive normal form, which is unique, so that equal demands are equal objects
(Bacchus & Kabanza, Planning for Temporally Extended Goals, 1998).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeAlias

from vaso.errors import FormulaError
from vaso.ltl.syntax import Binary, Constant, Formula, Unary
from vaso.ltl.traverse import PAST_OPERATORS

__all__ = ["DONE", "LOST", "Demand", "Progression", "both", "demand", "either", "only"]

Demand: TypeAlias = frozenset[frozenset[Formula]]
"""A disjunction of conjunctions of formulas, no conjunction containing another."""

DONE: Demand = frozenset({frozenset()})
LOST: Demand = frozenset()

MAX_TERMS = 128


def either(one: Demand, other: Demand) -> Demand:
    """The disjunction."""
    return _minimal(one | other)


def both(one: Demand, other: Demand) -> Demand:
    """The conjunction.

    Raises:
        FormulaError: It has too many alternatives.
    """
    if len(one) * len(other) > MAX_TERMS * MAX_TERMS:
        raise FormulaError("the formula has too many alternatives to be watched step by step")
    return _minimal(a | b for a in one for b in other)


def only(demanded: Demand, wanted: Callable[[Formula], bool]) -> Demand:
    """The same demand with all formulas taken for granted that are not wanted."""
    return _minimal(frozenset(f for f in term if wanted(f)) for term in demanded)


def demand(formula: Formula) -> Demand:
    """The demand that a formula in negation normal form holds from the next step on."""
    match formula:
        case Constant(value):
            return DONE if value else LOST
        case Binary("&", left, right):
            return both(demand(left), demand(right))
        case Binary("|", left, right):
            return either(demand(left), demand(right))
    return frozenset({frozenset({formula})})


class Progression:
    """Takes formulas through one step.

    Args:
        value: The value, in this step, of literals and of formulas about the past.
    """

    def __init__(self, value: Callable[[Formula], bool]) -> None:
        self._value = value
        self._known: dict[Formula, Demand] = {}

    def after(self, demanded: Demand) -> Demand:
        """What is left of a demand after the step.

        Raises:
            FormulaError: It has too many alternatives.
        """
        left: Demand = LOST
        for term in demanded:
            rest = DONE
            for formula in term:
                rest = both(rest, self._formula(formula))
            left = either(left, rest)
        if len(left) > MAX_TERMS:
            raise FormulaError("the formula has too many alternatives to be watched step by step")
        return left

    def _formula(self, formula: Formula) -> Demand:
        if formula not in self._known:
            self._known[formula] = self._progress(formula)
        return self._known[formula]

    def _progress(self, formula: Formula) -> Demand:
        again = frozenset({frozenset({formula})})
        if not _looks_ahead(formula):
            return DONE if self._value(formula) else LOST
        match formula:
            case Binary("&", left, right):
                return both(self._formula(left), self._formula(right))
            case Binary("|", left, right):
                return either(self._formula(left), self._formula(right))
            case Unary("X", operand):
                return demand(operand)
            case Unary("F", operand):
                return either(self._formula(operand), again)
            case Unary("G", operand):
                return both(self._formula(operand), again)
            case Binary("U" | "W", left, right):
                return either(self._formula(right), both(self._formula(left), again))
            case Binary("V", left, right):
                return both(self._formula(right), either(self._formula(left), again))
        raise AssertionError(f"not in negation normal form: {formula}")


def _looks_ahead(formula: Formula) -> bool:
    match formula:
        case Unary("!", _) | Constant(_):
            return False
        case Unary(op, _) | Binary(op, _, _):
            return op not in PAST_OPERATORS
    return False


def _minimal(terms: Iterable[frozenset[Formula]]) -> Demand:
    kept: list[frozenset[Formula]] = []
    for term in sorted(set(terms), key=len):
        if not any(other <= term for other in kept):
            kept.append(term)
    return frozenset(kept)
