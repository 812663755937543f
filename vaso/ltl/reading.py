"""Where the reading of a formula is likely to surprise, and what was probably meant.

Unary temporal operators bind tightest, so ``F !p & !q -> F !stop`` is
``((F !p) & !q) -> (F !stop)``. People, and language models, mostly mean
``F(!p & !q) -> F !stop``. The parser uses these rules to warn, the printer to put brackets where
it would otherwise write a misleading text.
"""

from __future__ import annotations

from vaso.ltl.syntax import Binary, BinaryOp, Formula, Unary
from vaso.ltl.traverse import TEMPORAL_OPERATORS, is_propositional, is_temporal, subformulas

__all__ = ["associates_unexpectedly", "intended", "is_misleading", "regrouped"]

_BINARY_TEMPORAL = frozenset("UVWST")
_TIGHT = frozenset(["&", "|", "xor"]) | _BINARY_TEMPORAL


def is_misleading(op: BinaryOp, left: Formula, left_open: bool, right: Formula) -> bool:
    """Tell whether a reader may take the temporal operator on the left to govern the right as well.

    Args:
        op: The binary operator in the middle.
        left: Its left operand.
        left_open: Whether ``left`` ends with the unbracketed operand of a unary temporal operator,
            as ``F !p`` and ``a & F b`` do and ``F (p)`` and ``(F p)`` do not.
        right: Its right operand.
    """
    if not left_open:
        return False
    if op in _TIGHT:
        return is_propositional(right)
    if not (isinstance(left, Unary) and left.op in TEMPORAL_OPERATORS):
        return False
    if op == "->" and left.op == "F":
        return is_propositional(right)
    return left.op == "G" and _looks_one_step_ahead(right)


def _looks_one_step_ahead(formula: Formula) -> bool:
    temporal = filter(is_temporal, subformulas(formula))
    return all(isinstance(f, Unary) and f.op == "X" for f in temporal)


def associates_unexpectedly(op: BinaryOp, left: Formula | None, right: Formula | None) -> bool:
    """Tell whether other tools, or a reader, would group two neighbouring operators otherwise.

    NuSMV reads ``a U b U c`` from the left and lets ``<->`` bind tighter than ``->``. Most texts
    on LTL do neither.

    Args:
        op: The outer operator.
        left: Its left operand, or None where that has brackets.
        right: Its right operand, or None where that has brackets.
    """
    if op in _BINARY_TEMPORAL:
        return isinstance(left, Binary) and left.op in _BINARY_TEMPORAL
    sides = [side.op for side in (left, right) if isinstance(side, Binary)]
    return op == "->" and "<->" in sides


def intended(op: BinaryOp, left: Formula, right: Formula) -> Formula:
    """Return what the writer of a misleading ``left op right`` probably meant."""
    match left:
        case Unary("F", operand) if op == "->":
            return Binary(op, Unary("F", operand), Unary("F", right))
        case Unary(head, operand) if head == "!" or is_temporal(operand):
            return Unary(head, intended(op, operand, right))
        case Unary(head, operand):
            return Unary(head, Binary(op, operand, right))
        case Binary(outer, first, second):
            return Binary(outer, first, intended(op, second, right))
    return Binary(op, left, right)


def regrouped(op: BinaryOp, left: Formula, right: Formula) -> Formula:
    """Return the usual grouping of operators that associate unexpectedly."""
    match (op, left, right):
        case ("->", _, Binary("<->", first, second)):
            return Binary("<->", Binary("->", left, first), second)
        case ("->", Binary("<->", first, second), _):
            return Binary("<->", first, Binary("->", second, right))
        case (_, Binary(inner, first, second), _) if inner in _BINARY_TEMPORAL:
            return Binary(inner, first, regrouped(op, second, right))
    return Binary(op, left, right)
