"""The safety part of a formula: what finitely many steps can violate for good.

Every property is the conjunction of a safety and a liveness property (Alpern & Schneider, Defining
Liveness, 1985). Here the safety part is read off the form: in negation normal form, each ``p U q``
becomes ``p W q`` ("p until q, if q ever comes") and each ``F p`` is dropped. All operators of that
form are monotone, so the formula implies its safety part; and the formula itself is what is left to
be brought about, so nothing is lost: formula = safety part & formula.
"""

from __future__ import annotations

from dataclasses import dataclass

from vaso.ltl import TRUE, Binary, Formula, Unary, fold, is_syntactically_safe, nnf, simplify
from vaso.ltl.traverse import rebuild

__all__ = ["Split", "safety_part", "split"]


@dataclass(frozen=True, slots=True)
class Split:
    """A formula in two parts, whose conjunction it is.

    Attributes:
        safety: What can be violated in finitely many steps; ``TRUE`` where there is no such part.
        liveness: What must come about some day; None for a safety property.
    """

    safety: Formula
    liveness: Formula | None


def split(formula: Formula) -> Split:
    """Split a formula into its safety part and what is left of it, if anything is."""
    simple = simplify(formula)
    if is_syntactically_safe(simple):
        return Split(simple, None)
    return Split(safety_part(simple), simple)


def safety_part(formula: Formula) -> Formula:
    """A safety property that the formula implies; the formula itself where its form is safe."""
    return simplify(fold(nnf(formula), _safe))


def _safe(node: Formula, parts: tuple[Formula, ...]) -> Formula:
    match node:
        case Unary("F", _):
            return TRUE
        case Binary("U", _, _):
            return Binary("W", parts[0], parts[1])
    return rebuild(node, parts)
