"""Printing formulas with mathematical symbols, for terminals and reports.

The boolean operators become symbols, the temporal ones stay letters. The usual box and diamond are
a bad choice for a terminal: a box is also what a font shows for a character that it lacks, and
fonts disagree about the width of both. The text reads back as the same formula.
"""

from __future__ import annotations

from vaso.ltl.syntax import Formula, Term
from vaso.ltl.text import Symbols, to_text

__all__ = ["to_unicode"]

_SYMBOLS: Symbols = {
    "!": "¬",
    "&": "∧",
    "|": "∨",
    "xor": "⊕",
    "->": "→",
    "<->": "↔",
    "<=": "≤",
    ">=": "≥",
    "==": "=",
    "!=": "≠",
    "*": "·",
}


def to_unicode(formula: Formula | Term) -> str:
    """Return the canonical text of a formula with symbols: ``G(people_observed → X ¬forward)``."""
    return to_text(formula, _SYMBOLS)
