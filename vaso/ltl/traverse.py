"""Walking formulas: one fold, and the questions about a formula that it answers.

Everything that computes something *from* a formula is a fold: what a node yields depends only on
the node and on what its operands yield. Writing the walk once, without recursion, keeps every
printer and transformation a small function and makes the depth of a formula irrelevant.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TypeVar

from vaso.ltl.syntax import (
    Arithmetic,
    Atom,
    Binary,
    Comparison,
    Formula,
    Proposition,
    Term,
    Unary,
    Variable,
)

__all__ = [
    "PAST_OPERATORS",
    "TEMPORAL_OPERATORS",
    "atoms",
    "comparisons",
    "depth",
    "fold",
    "fold_term",
    "has_past",
    "is_propositional",
    "is_temporal",
    "map_atoms",
    "operands",
    "past_depth",
    "propositions",
    "rebuild",
    "size",
    "subformulas",
    "substitute",
    "variables",
    "variables_of",
]

N = TypeVar("N")
R = TypeVar("R")

PAST_OPERATORS = frozenset("YZOHST")
TEMPORAL_OPERATORS = frozenset("XFGUVW") | PAST_OPERATORS


def _fold(
    root: N, children: Callable[[N], tuple[N, ...]], combine: Callable[[N, tuple[R, ...]], R]
) -> R:
    results: dict[N, R] = {}
    pending = [root]
    while pending:
        node = pending[-1]
        if node in results:
            pending.pop()
            continue
        below = children(node)
        depth = len(pending)
        for child in reversed(below):
            if child not in results:
                pending.append(child)
        if len(pending) == depth:
            pending.pop()
            results[node] = combine(node, tuple([results[child] for child in below]))
    return results[root]


def fold(formula: Formula, combine: Callable[[Formula, tuple[R, ...]], R]) -> R:
    """Compute a value bottom-up.

    Args:
        formula: The formula to walk.
        combine: Called once for every distinct subformula with the values of its operands.

    Returns:
        What ``combine`` returns for ``formula``.
    """
    return _fold(formula, operands, combine)


def fold_term(term: Term, combine: Callable[[Term, tuple[R, ...]], R]) -> R:
    """Do what :func:`fold` does, for a term."""
    return _fold(term, _terms_of, combine)


def operands(formula: Formula) -> tuple[Formula, ...]:
    """Return the direct operands; atoms and constants have none."""
    if isinstance(formula, Binary):  # not `match`: this is called more often than anything else
        return (formula.left, formula.right)
    if isinstance(formula, Unary):
        return (formula.operand,)
    return ()


def _terms_of(term: Term) -> tuple[Term, ...]:
    return (term.left, term.right) if isinstance(term, Arithmetic) else ()


def subformulas(formula: Formula) -> Iterator[Formula]:
    """Yield every distinct subformula once, operands before the formulas they occur in."""
    found: list[Formula] = []
    fold(formula, lambda node, _: found.append(node))
    return iter(found)


def atoms(formula: Formula) -> frozenset[Atom]:
    """Return the propositions and comparisons of a formula."""
    return frozenset(f for f in subformulas(formula) if isinstance(f, Proposition | Comparison))


def comparisons(formula: Formula) -> frozenset[Comparison]:
    """Return the numeric comparisons of a formula."""
    return frozenset(f for f in subformulas(formula) if isinstance(f, Comparison))


def propositions(formula: Formula) -> frozenset[str]:
    """Return the names of the boolean propositions."""
    return frozenset(f.name for f in subformulas(formula) if isinstance(f, Proposition))


def variables(formula: Formula) -> frozenset[str]:
    """Return the names of the numeric propositions."""
    return variables_of(comparisons(formula))


def variables_of(compared: Iterable[Comparison]) -> frozenset[str]:
    """Return the names of the numeric propositions in some comparisons."""
    found: set[str] = set()

    def note(term: Term, _: tuple[None, ...]) -> None:
        if isinstance(term, Variable):
            found.add(term.name)

    for comparison in compared:
        fold_term(comparison.left, note)
        fold_term(comparison.right, note)
    return frozenset(found)


def size(formula: Formula) -> int:
    """Return the number of nodes, counting a comparison as one."""
    return fold(formula, lambda _, sizes: 1 + sum(sizes))


def depth(formula: Formula) -> int:
    """Return the length of the longest chain of nested operators, arithmetic included."""

    def combine(node: Formula, depths: tuple[int, ...]) -> int:
        if isinstance(node, Comparison):
            return max(_term_depth(node.left), _term_depth(node.right))
        return 1 + max(depths) if depths else 0

    return fold(formula, combine)


def _term_depth(term: Term) -> int:
    return fold_term(term, lambda _, depths: 1 + max(depths) if depths else 0)


def is_temporal(formula: Formula) -> bool:
    """Tell whether the outermost operator is temporal."""
    return isinstance(formula, Unary | Binary) and formula.op in TEMPORAL_OPERATORS


def is_propositional(formula: Formula) -> bool:
    """Tell whether the formula speaks about one step only."""
    return not any(is_temporal(f) for f in subformulas(formula))


def has_past(formula: Formula) -> bool:
    """Tell whether any past operator occurs."""
    return past_depth(formula) > 0


def past_depth(formula: Formula) -> int:
    """Return how many past operators are nested at most."""

    def count(node: Formula, depths: tuple[int, ...]) -> int:
        own = isinstance(node, Unary | Binary) and node.op in PAST_OPERATORS
        return max(depths, default=0) + own

    return fold(formula, count)


def rebuild(formula: Formula, parts: tuple[Formula, ...]) -> Formula:
    """Return the same node over new operands."""
    match formula:
        case Unary(op, _):
            return Unary(op, parts[0])
        case Binary(op, _, _):
            return Binary(op, parts[0], parts[1])
    return formula


def map_atoms(formula: Formula, change: Callable[[Atom], Formula]) -> Formula:
    """Replace every proposition and comparison by what ``change`` returns for it."""

    def replace(node: Formula, parts: tuple[Formula, ...]) -> Formula:
        if isinstance(node, Proposition | Comparison):
            return change(node)
        return rebuild(node, parts)

    return fold(formula, replace)


def substitute(formula: Formula, replacements: Mapping[Formula, Formula]) -> Formula:
    """Replace subformulas; where one replaced formula contains another, the larger one wins.

    Args:
        formula: The formula to change.
        replacements: What each subformula becomes; the replacements are not searched again.
    """

    def replace(node: Formula, parts: tuple[Formula, ...]) -> Formula:
        return replacements.get(node) or rebuild(node, parts)

    return fold(formula, replace)
