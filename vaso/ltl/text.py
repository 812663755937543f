"""The canonical ASCII text of a formula, and its fully bracketed variant.

The canonical text has the fewest brackets with which it reads back as the same formula *and* does
not mislead: ``(F p) & q`` keeps brackets that the precedence of the operators alone would not ask
for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from vaso.ltl.reading import associates_unexpectedly, is_misleading
from vaso.ltl.syntax import (
    Arithmetic,
    Binary,
    Comparison,
    Constant,
    Formula,
    Number,
    Proposition,
    Term,
    Unary,
    Variable,
)
from vaso.ltl.traverse import TEMPORAL_OPERATORS, fold, fold_term, size

__all__ = ["Symbols", "number_text", "term_text", "to_bracketed", "to_text"]

_ATOM, _UNARY = 9, 7
_PRECEDENCE: Mapping[str, int] = {
    "->": 1,
    "<->": 2,
    "|": 3,
    "xor": 3,
    "&": 4,
    **dict.fromkeys("UVWST", 5),
}
_COMPARISON = 6  # below unary operators: `!(a < 1)` and `G(a < 1)` read best with brackets


Symbols: TypeAlias = Mapping[str, str]
"""How a printer spells operators that it does not write as in ASCII."""

ASCII: Symbols = {}


_READABLE = 5_000  # nodes; nobody minds more brackets than needed in a longer formula

_Rope: TypeAlias = "str | tuple[_Rope, ...]"


def _joined(rope: _Rope) -> str:
    """The text of a rope: parts of parts. Joined only once, so that deep formulas print quickly."""
    found: list[str] = []
    pending = [rope]
    while pending:
        part = pending.pop()
        if isinstance(part, str):
            found.append(part)
        else:
            pending.extend(reversed(part))
    return "".join(found)


@dataclass(frozen=True, slots=True)
class _Printed:
    """A printed formula, with what is needed to decide whether it needs brackets.

    Attributes:
        text: The text, in parts.
        binding: How tightly its outermost operator binds.
        is_open: Whether it ends with the unbracketed operand of a unary temporal operator.
    """

    text: _Rope
    binding: int
    is_open: bool = False

    def at_least(self, binding: int) -> _Printed:
        return self if self.binding >= binding else self.in_brackets()

    def in_brackets(self) -> _Printed:
        return _Printed(("(", self.text, ")"), _ATOM)


def to_text(node: Formula | Term, symbols: Symbols = ASCII) -> str:
    """Return the canonical text of a formula or term.

    Formulas of thousands of operators get brackets around every operand.

    Args:
        node: What to print.
        symbols: The spelling of the operators; ASCII by default.
    """
    if isinstance(node, Number | Variable | Arithmetic):
        return term_text(node, symbols)
    if size(node) > _READABLE:
        return _bracketed(node, symbols)
    return _joined(fold(node, lambda f, parts: _print(f, parts, symbols)).text)


def _print(formula: Formula, parts: tuple[_Printed, ...], symbols: Symbols) -> _Printed:
    match formula:
        case Constant(value):
            return _Printed(_spell("TRUE" if value else "FALSE", symbols), _ATOM)
        case Proposition(name):
            return _Printed(name, _ATOM)
        case Comparison(left, op, right):
            text = f"{term_text(left, symbols)} {_spell(op, symbols)} {term_text(right, symbols)}"
            return _Printed(text, _COMPARISON)
        case Unary(op, _):
            return _print_unary(op, parts[0], symbols)
        case Binary():
            return _print_binary(formula, parts[0], parts[1], symbols)


def _print_unary(op: str, operand: _Printed, symbols: Symbols) -> _Printed:
    is_temporal = op in TEMPORAL_OPERATORS
    inner = operand.at_least(_UNARY)
    bracketed = inner is not operand
    space = " " if is_temporal and not bracketed else ""
    is_open = not bracketed if is_temporal else inner.is_open
    return _Printed((_spell(op, symbols) + space, inner.text), _UNARY, is_open)


def _print_binary(formula: Binary, left: _Printed, right: _Printed, symbols: Symbols) -> _Printed:
    own = _PRECEDENCE[formula.op]
    to_the_right = formula.op == "->"
    left = left.at_least(own + to_the_right)
    right = right.at_least(own + (not to_the_right))
    if is_misleading(formula.op, formula.left, left.is_open, formula.right) or (
        left.binding != _ATOM and associates_unexpectedly(formula.op, formula.left, None)
    ):
        left = left.in_brackets()
    if right.binding != _ATOM and associates_unexpectedly(formula.op, None, formula.right):
        right = right.in_brackets()
    text = (left.text, f" {_spell(formula.op, symbols)} ", right.text)
    return _Printed(text, own, right.is_open)


def _spell(op: str, symbols: Symbols) -> str:
    return symbols.get(op, op)


def number_text(value: float) -> str:
    """Return the shortest text of a number: ``10`` for 10.0, ``0.5`` for 0.5."""
    return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)


def term_text(term: Term, symbols: Symbols = ASCII) -> str:
    """Return the text of a term with the fewest brackets."""
    return _joined(fold_term(term, lambda t, parts: _print_term(t, parts, symbols)).text)


def _print_term(term: Term, parts: tuple[_Printed, ...], symbols: Symbols) -> _Printed:
    match term:
        case Number(value):
            return _Printed(number_text(value), _ATOM)
        case Variable(name):
            return _Printed(name, _ATOM)
        case Arithmetic(op, _, _):
            own = 1 if op in "+-" else 2
            left, right = parts[0].at_least(own), parts[1].at_least(own + 1)
            return _Printed((left.text, f" {_spell(op, symbols)} ", right.text), own)


def to_bracketed(formula: Formula) -> str:
    """Return a text with brackets around every operand that is more than a literal."""
    return _bracketed(formula, ASCII)


def _bracketed(formula: Formula, symbols: Symbols) -> str:
    def show(node: Formula, parts: tuple[_Printed, ...]) -> _Printed:
        match node:
            case Unary("!", Proposition() | Constant()):
                return _Printed((_spell("!", symbols), parts[0].text), _ATOM)
            case Unary(op, _):
                inner = parts[0].at_least(_ATOM)
                space = " " if inner is parts[0] and op != "!" else ""
                return _Printed((_spell(op, symbols) + space, inner.text), _UNARY)
            case Binary(op, _, _):
                left, right = (part.at_least(_ATOM) for part in parts)
                return _Printed((left.text, f" {_spell(op, symbols)} ", right.text), 0)
        return _print(node, parts, symbols)

    return _joined(fold(formula, show).text)
