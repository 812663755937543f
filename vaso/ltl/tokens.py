"""What the lexer hands to the grammar."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["OPERAND_ENDS", "Token"]

OPERAND_ENDS = frozenset(["WORD", "CALL", "NAME", "NUMBER", "CONSTANT", "RPAR"])
"""Types of token with which an operand can end."""


@dataclass(frozen=True, slots=True)
class Token:
    """A terminal of the grammar.

    Attributes:
        type: The terminal; before names are joined also ``WORD`` and ``CALL``.
        value: The canonical operator, the name or the number.
        start: Offset of its first character in the text of the formula.
        end: Offset behind its last character.
    """

    type: str
    value: str
    start: int
    end: int
