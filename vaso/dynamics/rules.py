"""Which rules say something about every instant of a period, and which only about samples."""

from __future__ import annotations

from dataclasses import dataclass

from vaso.ltl import (
    Binary,
    Comparison,
    Formula,
    Proposition,
    Term,
    Unary,
    Variable,
    comparisons,
    fold,
    map_atoms,
    nnf,
)
from vaso.ltl.traverse import fold_term
from vaso.platforms.response import Response, SetPoint

__all__ = ["Invariant", "invariant", "names_in"]

_MOMENT = "it asks for a moment at which {}, and not for every instant"
_TWO = "{} and {} would have to be compared at the same instant"
_FIRST = "{} is asked for at single steps only"


@dataclass(frozen=True, slots=True)
class Invariant:
    """A rule that stays meaningful when its comparisons are read over whole periods.

    Attributes:
        formula: The rule in negation normal form.
        comparisons: Its comparisons.
    """

    formula: Formula
    comparisons: tuple[Comparison, ...]

    def with_labels(self, prefix: str) -> Formula:
        """The rule with the proposition ``prefix`` and a number in place of each comparison."""
        names = {c: Proposition(f"{prefix}{i}") for i, c in enumerate(self.comparisons)}
        return map_atoms(self.formula, lambda a: names[a] if isinstance(a, Comparison) else a)


def invariant(rule: Formula) -> Invariant | str:
    """The rule as an invariant of numbers, or why it is none.

    A comparison can be read as "throughout the period" where it stands under ``G``, with ``X``,
    ``&``, and ``|`` or ``->`` whose other side has no numbers.
    """
    formula = nnf(rule)
    why = _refusal(formula)
    if why:
        return why
    return Invariant(formula, tuple(sorted(comparisons(formula), key=str)))


def names_in(comparison: Comparison) -> frozenset[str]:
    """The numeric propositions of a comparison."""
    return _names(comparison.left) | _names(comparison.right)


def _names(term: Term) -> frozenset[str]:
    found: set[str] = set()

    def note(part: Term, _: tuple[None, ...]) -> None:
        if isinstance(part, Variable):
            found.add(part.name)

    fold_term(term, note)
    return frozenset(found)


def moves(comparison: Comparison, response: Response) -> bool:
    """True when some number of a comparison can change inside a period."""
    kinds = [response.quantities.get(name) for name in names_in(comparison)]
    return any(not isinstance(kind, SetPoint) for kind in kinds)


@dataclass(frozen=True, slots=True)
class _Part:
    """What is known of a subformula.

    Attributes:
        bare: A comparison that is not under ``G`` yet, or None.
        count: How many comparisons there are in it.
        why: Why the rule is no invariant, or nothing.
    """

    bare: Comparison | None = None
    count: int = 0
    why: str = ""


def _refusal(formula: Formula) -> str:
    part = fold(formula, _part)
    if part.why or part.bare is None:
        return part.why
    return _FIRST.format(part.bare)


def _part(node: Formula, parts: tuple[_Part, ...]) -> _Part:
    why = next((p.why for p in parts if p.why), "")
    count = sum(p.count for p in parts)
    bare = next((p.bare for p in parts if p.bare is not None), None)
    match node:
        case Comparison():
            return _Part(node, 1)
        case _ if why or not count:
            return _Part(bare, count, why)
        case Unary("G", _):
            return _Part(None, count)
        case Unary("X", _) | Binary("&", _, _):
            return _Part(bare, count)
        case Binary("|", left, right) if not all(p.count for p in parts):
            return _Part(bare, count)
        case Binary("|", left, right):
            both = [min(comparisons(side), key=str) for side in (left, right)]
            return _Part(bare, count, _TWO.format(*both))
    first = min(comparisons(node), key=str)
    return _Part(bare, count, _MOMENT.format(first))
