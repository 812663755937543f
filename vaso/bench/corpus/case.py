"""A formula of a benchmark family."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

__all__ = ["Case", "all_of", "any_of", "nexts"]


@dataclass(frozen=True, slots=True)
class Case:
    """A formula, and whether it is satisfiable.

    Attributes:
        family: The family that it belongs to.
        name: Family and parameters.
        formula: Its text.
        sat: The answer where it follows from how the formula was made, else None.
    """

    family: str
    name: str
    formula: str
    sat: bool | None


def all_of(parts: Iterable[str]) -> str:
    """A conjunction, nested to the left with brackets as in the published files."""
    return _nested("&", parts)


def any_of(parts: Iterable[str]) -> str:
    """A disjunction, likewise."""
    return _nested("|", parts)


def _nested(op: str, parts: Iterable[str]) -> str:
    first, *others = parts
    text = "(" * len(others) + first
    return text + "".join(f" {op} {part})" for part in others)


def nexts(count: int, formula: str) -> str:
    """A formula that many steps ahead."""
    return "(X " * count + formula + ")" * count
