"""Normal forms: negations pushed to the atoms, and cheap simplification.

The dualities are in Baier & Katoen (2008), section 5.1.4; ``Y`` and ``Z`` differ only in the first
step, where there is no step before: ``Y p`` is false there and ``Z p`` true, so each is the dual
of the other.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from vaso.ltl.syntax import (
    FALSE,
    TRUE,
    Binary,
    BinaryOp,
    Comparison,
    ComparisonOp,
    Constant,
    Formula,
    Unary,
    UnaryOp,
    negate,
)
from vaso.ltl.traverse import fold, rebuild, subformulas

__all__ = [
    "DUAL_BINARY",
    "DUAL_UNARY",
    "is_syntactically_safe",
    "nnf",
    "simplify",
    "simplify_node",
]

DUAL_UNARY: Mapping[UnaryOp, UnaryOp] = {
    "X": "X",
    "F": "G",
    "G": "F",
    "Y": "Z",
    "Z": "Y",
    "O": "H",
    "H": "O",
}
DUAL_BINARY: Mapping[BinaryOp, BinaryOp] = {
    "&": "|",
    "|": "&",
    "U": "V",
    "V": "U",
    "S": "T",
    "T": "S",
}
_OPPOSITE: Mapping[ComparisonOp, ComparisonOp] = {
    "<": ">=",
    ">=": "<",
    ">": "<=",
    "<=": ">",
    "==": "!=",
    "!=": "==",
}


class _Pair(NamedTuple):
    """A formula and its negation, both in negation normal form."""

    yes: Formula
    no: Formula


def nnf(formula: Formula) -> Formula:
    """Return the negation normal form: ``!`` only in front of propositions.

    ``->``, ``<->`` and ``xor`` are eliminated, negated comparisons become the opposite comparison.
    ``W`` stays. Nested ``<->`` and ``xor`` can double the text at every level; in memory, equal
    parts are shared.
    """
    return fold(formula, _nnf_pair).yes


def _nnf_pair(formula: Formula, parts: tuple[_Pair, ...]) -> _Pair:
    match formula:
        case Comparison(left, op, right):
            return _Pair(formula, Comparison(left, _OPPOSITE[op], right))
        case Unary("!", _):
            return _Pair(parts[0].no, parts[0].yes)
        case Unary(op, _):
            return _Pair(Unary(op, parts[0].yes), Unary(DUAL_UNARY[op], parts[0].no))
        case Binary(op, _, _):
            return _nnf_binary(op, *parts)
    return _Pair(formula, negate(formula))


def _nnf_binary(op: BinaryOp, a: _Pair, b: _Pair) -> _Pair:
    match op:
        case "->":
            return _Pair(Binary("|", a.no, b.yes), Binary("&", a.yes, b.no))
        case "<->":
            return _Pair(_either(a, b, same=True), _either(a, b, same=False))
        case "xor":
            return _Pair(_either(a, b, same=False), _either(a, b, same=True))
        case "W":
            return _Pair(Binary("W", a.yes, b.yes), Binary("U", b.no, Binary("&", a.no, b.no)))
    return _Pair(Binary(op, a.yes, b.yes), Binary(DUAL_BINARY[op], a.no, b.no))


def _either(a: _Pair, b: _Pair, *, same: bool) -> Formula:
    first, second = (b.yes, b.no) if same else (b.no, b.yes)
    return Binary("|", Binary("&", a.yes, first), Binary("&", a.no, second))


def is_syntactically_safe(formula: Formula) -> bool:
    """Tell whether the form of the formula shows that it is a safety property.

    A formula whose negation normal form looks ahead only with ``X``, ``G``, ``V`` and ``W`` is a
    safety property: every violation shows after finitely many steps (Sistla, Safety, Liveness and
    Fairness in Temporal Logic, 1994). Past operators do no harm. The converse does not hold: a
    safety property can be written so that its form does not show it.
    """
    return not any(
        isinstance(f, Unary | Binary) and f.op in ("F", "U") for f in subformulas(nnf(formula))
    )


# ------------------------------------------------------------------------------------ simplifying


def simplify(formula: Formula) -> Formula:
    """Return an equivalent formula without constants, doubled operators and repeated operands.

    Only rules that look at a node and its operands are used: the result is never larger, but not
    always the smallest.
    """
    return fold(formula, lambda node, parts: simplify_node(rebuild(node, parts)))


def simplify_node(formula: Formula) -> Formula:
    """Simplify a formula whose operands are simple already."""
    match formula:
        case Unary("!", Unary("!", operand)):
            return operand
        case Unary("!", Constant(value)):
            return FALSE if value else TRUE
        case Unary(op, operand):
            return _simplify_unary(op, operand)
        case Binary("&" | "|" as op, left, right):
            return _simplify_lattice(op, left, right)
        case Binary("->" | "<->" | "xor" as op, left, right):
            return _simplify_conditional(op, left, right)
        case Binary(op, left, right):
            return _simplify_temporal(op, left, right)
    return formula


def _simplify_unary(op: UnaryOp, operand: Formula) -> Formula:
    match (op, operand):
        case ("X" | "F" | "G" | "O" | "H", Constant()):
            return operand
        case ("Y", Constant(False)) | ("Z", Constant(True)):
            return operand
        case ("F" | "G" | "O" | "H", Unary(inner, _)) if inner == op:
            return operand
        case ("F", Unary("G", Unary("F", _))) | ("G", Unary("F", Unary("G", _))):
            # "Infinitely often" has the same truth value in every step, whatever the operand is,
            # so a further F or G in front of it changes nothing.
            return operand
    return Unary(op, operand)


def _simplify_lattice(op: BinaryOp, left: Formula, right: Formula) -> Formula:
    neutral, absorbing = (TRUE, FALSE) if op == "&" else (FALSE, TRUE)
    if absorbing in (left, right) or _are_opposite(left, right):
        return absorbing
    if left in (neutral, right):
        return right
    return left if right == neutral else Binary(op, left, right)


def _are_opposite(left: Formula, right: Formula) -> bool:
    return left == Unary("!", right) or right == Unary("!", left)


def _simplify_conditional(op: BinaryOp, left: Formula, right: Formula) -> Formula:
    if op == "->":
        if left in (FALSE, right) or right == TRUE:
            return TRUE
        if left == TRUE:
            return right
        return negate(left) if right == FALSE else Binary(op, left, right)
    same, different = (TRUE, FALSE) if op == "<->" else (FALSE, TRUE)
    if left == right:
        return same
    if _are_opposite(left, right):
        return different
    for one, other in ((left, right), (right, left)):
        if isinstance(one, Constant):
            return other if one == same else negate(other)
    return Binary(op, left, right)


def _simplify_temporal(op: BinaryOp, left: Formula, right: Formula) -> Formula:
    if left == right or (isinstance(right, Constant) and op in "USVT"):
        return right
    match (op, left, right):
        case ("W", _, Constant(True)) | ("W", Constant(True), _):
            return TRUE
        case ("W" | "U" | "S", Constant(False), _) | ("V" | "T", Constant(True), _):
            return right
        case ("W", _, Constant(False)) | ("V", Constant(False), _):
            return _simplify_unary("G", left if op == "W" else right)
        case ("U", Constant(True), _):
            return _simplify_unary("F", right)
        case ("S", Constant(True), _):
            return _simplify_unary("O", right)
        case ("T", Constant(False), _):
            return _simplify_unary("H", right)
    return Binary(op, left, right)
