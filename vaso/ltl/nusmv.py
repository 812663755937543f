"""Printing formulas for NuSMV.

Every operand is bracketed, so nothing depends on NuSMV's precedence. Names are the caller's
business: NuSMV reserves many words (``F``, ``next``, ``in`` ...) and reads ``alt-1`` as one
identifier, so the model that the formula is checked on decides how a proposition is called in it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from vaso.errors import FormulaError
from vaso.ltl.syntax import Binary, Comparison, Constant, Formula, Proposition, Unary
from vaso.ltl.traverse import fold

__all__ = ["to_nusmv"]

Names = Mapping[str, str] | Callable[[str], str]


def to_nusmv(
    formula: Formula, names: Names, comparison: Callable[[Comparison], str] | None = None
) -> str:
    """Return the formula in the syntax of NuSMV (User Manual 2.6, section 2.4.3).

    Args:
        formula: The formula.
        names: The identifier in the model for each boolean proposition.
        comparison: Called for every numeric comparison; returns the boolean identifier or
            expression that stands for it in the model. May be left out for formulas without
            comparisons.

    Raises:
        FormulaError: A proposition or comparison has no counterpart in the model.
    """

    def show(node: Formula, parts: tuple[str, ...]) -> str:
        match node:
            case Constant(value):
                return "TRUE" if value else "FALSE"
            case Proposition(name):
                return names(name) if callable(names) else _look_up(name, names)
            case Comparison():
                return _compared(node, comparison)
            case Unary(op, _):
                return f"({op} {parts[0]})"
            case Binary("W", _, _):
                # NuSMV has no weak until: p W q is q V (p | q).
                return f"({parts[1]} V ({parts[0]} | {parts[1]}))"
            case Binary(op, _, _):
                return f"({parts[0]} {op} {parts[1]})"

    return fold(formula, show)


def _look_up(name: str, names: Mapping[str, str]) -> str:
    if name not in names:
        raise FormulaError(
            f"the proposition {name} is not part of the model",
            hint=f"it has: {', '.join(sorted(names)) or 'no propositions'}",
        )
    return names[name]


def _compared(node: Comparison, comparison: Callable[[Comparison], str] | None) -> str:
    if comparison is None:
        raise FormulaError(f"the comparison {node} has no counterpart in the model")
    return comparison(node)
