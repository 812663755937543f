"""Occurrences of subformulas in a rule, and what a rule becomes when one of them is given up.

Replacing one occurrence by the constant that makes the rule as strong as possible (false where the
rule gains from it, true where it loses) gives a *mutant*, which implies the rule. If the mutant
holds as well, that occurrence does not matter for the verdict (Kupferman & Vardi, Vacuity
Detection in Temporal Model Checking, 2003). Every operator, past ones included, keeps or
turns the direction of each operand, except ``<->`` and ``xor``. These are given up as a whole,
which is the same as giving up one of their sides: a side that may be anything can always be chosen
so that the two differ, or agree.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from vaso.ltl import FALSE, TRUE, Binary, Formula, Unary, atoms
from vaso.ltl.traverse import operands, rebuild

__all__ = ["Occurrence", "mutant", "occurrences"]

_MIXED = ("<->", "xor")


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A subformula at one place of a rule.

    Attributes:
        formula: The subformula.
        path: Which operand to take at every operator, from the whole rule on.
        positive: True where the rule gains when the subformula becomes true.
        triggers: Where the rule asks for the subformula at all times (``G``, ``&``, ``X``, and
            the promise of an implication): the conditions under which it does, outermost first.
            None elsewhere.
        is_promise: True for the promise of an implication, also of one written ``!a | b``.
    """

    formula: Formula
    path: tuple[int, ...] = ()
    positive: bool = True
    triggers: tuple[Formula, ...] | None = ()
    is_promise: bool = False

    @property
    def is_leaf(self) -> bool:
        """True where there is nothing smaller to give up."""
        return not operands(self.formula) or _is_mixed(self.formula)

    def contains(self, other: Occurrence) -> bool:
        """True for the occurrence itself and those inside it."""
        return other.path[: len(self.path)] == self.path


def occurrences(rule: Formula) -> Iterator[Occurrence]:
    """Every occurrence that can be given up, outer ones first; no constants, nor the whole rule."""
    pending = [Occurrence(rule)]
    while pending:
        here = pending.pop()
        if here.path and atoms(here.formula):
            yield here
        if not _is_mixed(here.formula):
            pending += reversed([_inside(here, n) for n in range(len(operands(here.formula)))])


def mutant(rule: Formula, given_up: Iterable[Occurrence]) -> Formula:
    """The rule with some occurrences replaced by the constants that make the rule strongest."""
    for part in given_up:
        rule = _replaced(rule, part.path, FALSE if part.positive else TRUE)
    return rule


def _replaced(rule: Formula, path: Sequence[int], part: Formula) -> Formula:
    around = [rule]
    for index in path:
        around.append(operands(around[-1])[index])
    for outer, index in zip(reversed(around[:-1]), reversed(path), strict=True):
        parts = list(operands(outer))
        parts[index] = part
        part = rebuild(outer, tuple(parts))
    return part


def _is_mixed(formula: Formula) -> bool:
    return isinstance(formula, Binary) and formula.op in _MIXED


def _inside(outer: Occurrence, index: int) -> Occurrence:
    formula = outer.formula
    triggers = outer.triggers if outer.positive else None
    trigger: Formula | None = None
    turned = False
    match formula:
        case Unary("!", _):
            turned, triggers = True, None
        case Binary("->", left, _):
            turned = index == 0
            trigger, triggers = (left, triggers) if index else (None, None)
        case Binary("|", left, right):
            trigger = (
                _denied((left, right)[1 - index]) if not _denied((left, right)[index]) else None
            )
            triggers = triggers if trigger is not None else None
        case Unary("G" | "X", _) | Binary("&", _, _):
            pass
        case _:
            triggers = None
    if trigger is not None and triggers is not None:
        triggers = (*triggers, trigger)
    return Occurrence(
        operands(formula)[index],
        (*outer.path, index),
        outer.positive != turned,
        triggers,
        is_promise=trigger is not None and triggers is not None,
    )


def _denied(formula: Formula) -> Formula | None:
    """What a negation denies; None for any other formula."""
    return formula.operand if isinstance(formula, Unary) and formula.op == "!" else None
