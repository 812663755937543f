"""Propositions of several robots: ``stop`` of jackal is ``jackal.stop``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from vaso.errors import FormulaError
from vaso.ltl import (
    Arithmetic,
    Comparison,
    Formula,
    Number,
    ParsedFormula,
    Proposition,
    Term,
    Variable,
    map_atoms,
)
from vaso.ltl.traverse import fold_term

__all__ = ["Names", "rename"]


def rename(formula: Formula, change: Callable[[str], str]) -> Formula:
    """The formula with every proposition, boolean or numeric, under another name."""

    def term(node: Term, parts: tuple[Term, ...]) -> Term:
        match node:
            case Variable(name):
                return Variable(change(name))
            case Arithmetic(op, _, _):
                return Arithmetic(op, parts[0], parts[1])
            case Number():
                return node

    def atom(node: Proposition | Comparison) -> Formula:
        if isinstance(node, Proposition):
            return Proposition(change(node.name))
        return Comparison(fold_term(node.left, term), node.op, fold_term(node.right, term))

    return map_atoms(formula, atom)


class Names:
    """The full names of a composition, and what shorter names stand for.

    Args:
        members: For each member its name and the propositions that it has.
        alike: Groups of full names that always have the same value, such as shared sensors.
    """

    def __init__(
        self, members: Sequence[tuple[str, Iterable[str]]], alike: Iterable[Iterable[str]] = ()
    ) -> None:
        self.members = [name for name, _ in members]
        self.full = {f"{owner}.{name}" for owner, names in members for name in sorted(names)}
        self._group = {name: number for number, group in enumerate(alike) for name in group}

    def resolve(self, parsed: ParsedFormula) -> Formula:
        """The formula over full names.

        A name may leave out what is in front of a dot where that leaves no doubt; the least that
        can have been left out counts.

        Raises:
            FormulaError: A name is unknown, or could be that of several members.
        """
        return rename(parsed.formula, lambda name: self._one(name, parsed.text))

    def _one(self, name: str, text: str) -> str:
        if name in self.full:
            return name
        ending = sorted(full for full in self.full if full.endswith(f".{name}"))
        found = [f for f in ending if f.count(".") == min(g.count(".") for g in ending)]
        if len(found) == 1 or self._are_alike(found):
            return found[0]
        if found:
            raise FormulaError(
                f"'{name}' could be {' or '.join(found)}",
                source=text,
                hint=f"say which one, as in {found[0]}",
            )
        raise self._unknown(name, text)

    def _are_alike(self, found: Sequence[str]) -> bool:
        groups = {self._group.get(name) for name in found}
        return len(groups) == 1 and None not in groups

    def _unknown(self, name: str, text: str) -> FormulaError:
        owner, dot, _ = name.partition(".")
        if dot and owner not in self.members:
            return FormulaError(
                f"there is no member '{owner}'",
                source=text,
                expected=f"one of {', '.join(self.members)}",
            )
        has = sorted(n for n in self.full if not dot or n.startswith(f"{owner}."))
        return FormulaError(
            f"no member has the proposition '{name}'" if not dot else f"there is no '{name}'",
            source=text,
            expected=f"one of {', '.join(has)}" if has else None,
        )
