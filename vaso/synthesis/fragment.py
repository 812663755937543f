"""Which formulas deterministic Büchi automata can watch, by their form.

The classes of the safety-progress hierarchy (Manna & Pnueli, A Hierarchy of Temporal Properties,
1990), read off the negation normal form as by Esparza, Křetínský & Sickert (A Unified Translation
of Linear Temporal Logic to ω-Automata, 2020):

* *guarantee* (co-safety): looks ahead with ``X``, ``F`` and ``U`` only;
* *recurrence*: guarantees, closed under ``&``, ``|``, ``X``, ``G``, ``W`` and ``V``. It contains
  all safety properties, all boolean combinations of both, and ``G F p``.

GR(1) games have recurrence properties on both sides (Bloem et al., Synthesis of Reactive(1)
Designs, 2012). What is left outside are persistence properties such as ``F G p``.
"""

from __future__ import annotations

from vaso.ltl import FALSE, TRUE, Binary, Formula, Unary, nnf, simplify
from vaso.ltl.traverse import PAST_OPERATORS, fold, operands, rebuild, subformulas

__all__ = ["is_guarantee", "is_recurrence", "stronger", "weaker"]

_FUTURE = frozenset("XFGUVW")


def is_guarantee(formula: Formula) -> bool:
    """Tell whether a formula in negation normal form is a guarantee by its form."""
    return all(_op(f) not in ("G", "W", "V") for f in subformulas(formula))


def is_recurrence(formula: Formula) -> bool:
    """Tell whether a formula in negation normal form is a recurrence property by its form."""

    def good(node: Formula, parts: tuple[tuple[bool, bool], ...]) -> tuple[bool, bool]:
        op = _op(node)
        if op in PAST_OPERATORS:
            past = _is_past(node)
            return past, past
        guarantee = op not in ("G", "W", "V") and all(g for g, _ in parts)
        return guarantee, guarantee or (op not in ("F", "U") and all(r for _, r in parts))

    return fold(formula, good)[1]


def stronger(formula: Formula) -> Formula:
    """A recurrence property that implies the formula; the formula itself where it is one.

    Alternatives outside the class are dropped, and "at some time" becomes "now or in the next
    step", so that ``F G p`` becomes ``G p | X G p``. FALSE where nothing is left.
    """
    return simplify(fold(nnf(formula), _stronger))


def weaker(formula: Formula) -> Formula:
    """A recurrence property that the formula implies; the formula itself where it is one.

    Parts outside the class become ``G F p`` where they say ``F G p``, and are dropped otherwise.
    """
    return simplify(fold(nnf(formula), _weaker))


def _stronger(node: Formula, parts: tuple[Formula, ...]) -> Formula:
    whole = rebuild(node, parts)
    if is_recurrence(whole):
        return whole
    match node:
        case Unary("F", _):
            return Binary("|", parts[0], Unary("X", parts[0]))
        case Binary("U", _, _):
            later = Binary("&", parts[0], Unary("X", parts[1]))
            return Binary("|", parts[1], later)
    return FALSE if _op(node) in PAST_OPERATORS else whole


def _weaker(node: Formula, parts: tuple[Formula, ...]) -> Formula:
    whole = rebuild(node, parts)
    if is_recurrence(whole):
        return whole
    match whole:
        case Unary("F", Unary("G", inner)) if is_recurrence(Unary("F", inner)):
            return Unary("G", Unary("F", inner))
    return TRUE


def _is_past(node: Formula) -> bool:
    return all(_op(f) not in _FUTURE for f in subformulas(node))


def _op(node: Formula) -> str:
    return node.op if operands(node) and isinstance(node, Unary | Binary) else ""
