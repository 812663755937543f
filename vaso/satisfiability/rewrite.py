"""Rewriting that keeps satisfiability and makes the question smaller.

Not every rule gives an equivalent formula: a proposition that is only ever asked to be true may as
well be true always (the *pure literal* rule; every operator of a formula in negation normal form is
monotone). What is fixed in this way is reported, so that a behaviour can be completed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from vaso.ltl import (
    FALSE,
    TRUE,
    Binary,
    Constant,
    Formula,
    Proposition,
    Unary,
    conjunction,
    fold,
    nnf,
    simplify,
)
from vaso.ltl.normal import simplify_node
from vaso.ltl.traverse import rebuild

__all__ = ["Rewritten", "conjuncts", "rewrite"]

_ROUNDS = 8


@dataclass(frozen=True, slots=True)
class Rewritten:
    """A smaller question.

    Attributes:
        formulas: The conjuncts, in negation normal form; none if they hold of themselves, and
            ``FALSE`` alone if they never do.
        fixed: Propositions that may be taken to have one value in every step.
    """

    formulas: tuple[Formula, ...]
    fixed: Mapping[str, bool]


def rewrite(formulas: Iterable[Formula]) -> Rewritten:
    """Rewrite a conjunction of formulas without numeric comparisons."""
    parts = _split(nnf(simplify(f)) for f in formulas)
    fixed: dict[str, bool] = {}
    for _ in range(_ROUNDS):
        found = _constant(parts)
        if not found:
            break
        fixed |= found
        parts = _split(_replace(f, found) for f in parts)
    return Rewritten(tuple(_join_persistent(parts)), fixed)


def conjuncts(formula: Formula) -> Iterator[Formula]:
    """The operands of nested conjunctions, those under ``G`` too; ``TRUE`` has none."""
    pending = [formula]
    while pending:
        node = pending.pop()
        match node:
            case Constant(True):
                continue
            case Binary("&", left, right):
                pending += [right, left]
            case Unary("G", Binary("&", left, right)):
                pending += [Unary("G", right), Unary("G", left)]
            case _:
                yield node


def _split(formulas: Iterable[Formula]) -> list[Formula]:
    parts = list(dict.fromkeys(part for f in formulas for part in conjuncts(f)))
    return [FALSE] if FALSE in parts else parts


def _constant(parts: Sequence[Formula]) -> dict[str, bool]:
    """Propositions that occur with one sign only, or that a conjunct fixes in every step."""
    signs: dict[str, set[bool]] = {}
    forced: dict[str, bool] = {}
    for node in _nodes(parts):
        literal = _literal(node)
        if literal:
            signs.setdefault(literal[0], set()).add(literal[1])
    for part in parts:
        if isinstance(part, Unary) and part.op == "G" and (literal := _literal(part.operand)):
            forced.setdefault(*literal)
    pure = {name: next(iter(values)) for name, values in signs.items() if len(values) == 1}
    return pure | forced


def _nodes(parts: Sequence[Formula]) -> Iterator[Formula]:
    """Every distinct subformula, without the propositions below a ``!``."""
    seen: set[Formula] = set()
    pending = list(parts)
    while pending:
        node = pending.pop()
        if node in seen:
            continue
        seen.add(node)
        yield node
        match node:
            case Unary("!", _):
                continue
            case Unary(_, operand):
                pending.append(operand)
            case Binary(_, left, right):
                pending += [left, right]


def _literal(formula: Formula) -> tuple[str, bool] | None:
    match formula:
        case Proposition(name):
            return name, True
        case Unary("!", Proposition(name)):
            return name, False
    return None


def _replace(formula: Formula, values: Mapping[str, bool]) -> Formula:
    def change(node: Formula, parts: tuple[Formula, ...]) -> Formula:
        if isinstance(node, Proposition) and node.name in values:
            return TRUE if values[node.name] else FALSE
        return simplify_node(rebuild(node, parts))

    return fold(formula, change)


def _join_persistent(parts: Sequence[Formula]) -> Iterator[Formula]:
    """``F G p & F G q`` is ``F G(p & q)``: what holds from some time on, holds together."""
    persistent = []
    for part in parts:
        match part:
            case Unary("F", Unary("G", operand)):
                persistent.append(operand)
            case _:
                yield part
    if persistent:
        yield Unary("F", Unary("G", simplify(conjunction(persistent))))
