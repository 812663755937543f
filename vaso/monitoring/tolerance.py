"""Comparisons of measured numbers: no measurement is ever exactly 0.

A value within the platform's accuracy of a constant may be that constant. So ``==``, ``<=`` and
``>=``, which the constant itself satisfies, hold there: a vehicle that is told to fly at the very
limit that a rule allows does not break the rule by noise. ``!=`` is left as it is. Where being
equal to a constant matters to a rule, or the constant is the least that the number can be (an
altitude of 0), ``>`` and ``<`` against it ask for more than the accuracy, so that a vehicle on the
ground does not count as flying. A bound such as ``altitude < 10`` is taken as measured.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from vaso.errors import FormulaError
from vaso.ltl import Atom, Comparison, Number, Proposition, Variable, compare
from vaso.monitoring.monitor import Partial
from vaso.plan.transition_system import Label
from vaso.platforms import Platform

__all__ = ["EXACT", "Tolerance"]


class Tolerance:
    """How measured numbers are compared.

    Args:
        accuracy: By how much each may be off; a number that is not in it is exact.
        least: The least value of each, where it has one.
    """

    def __init__(
        self, accuracy: Mapping[str, float] | None = None, least: Mapping[str, float] | None = None
    ) -> None:
        self._accuracy = accuracy or {}
        self._least = least or {}

    @classmethod
    def of(cls, platform: Platform) -> Tolerance:
        """That of a platform."""
        least = {p.name: p.minimum for p in platform.propositions if p.minimum is not None}
        return cls(platform.accuracy, least)

    def letter(self, watched: Sequence[Atom], labels: Mapping[str, Label]) -> Partial:
        """The values of some atoms of a rule in a step; None for what the step does not say.

        Args:
            watched: The atoms of the rule in negation normal form.
            labels: The propositions that are known, with their values.
        """
        equated = {pair for atom in watched if (pair := _equated(atom)) is not None}
        return tuple(self._value(atom, labels, equated) for atom in watched)

    def _value(
        self, atom: Atom, labels: Mapping[str, Label], equated: set[tuple[str, float]]
    ) -> bool | None:
        if isinstance(atom, Proposition):
            value = labels.get(atom.name)
            return value if isinstance(value, bool) else None
        try:
            exact = compare(atom, labels)
        except FormulaError:  # a number is missing, not finite, or a term divides by zero
            return None
        match atom:
            case Comparison(Variable(name), op, Number(bound)) if self._accuracy.get(name):
                away = abs(float(labels[name]) - bound) > self._accuracy[name]
                if op in ("==", "<=", ">="):
                    return exact or not away
                if op in ("<", ">") and self._is_edge(name, bound, equated):
                    return exact and away
        return exact

    def _is_edge(self, name: str, bound: float, equated: set[tuple[str, float]]) -> bool:
        return (name, bound) in equated or self._least.get(name) == bound


EXACT = Tolerance()
"""Every number is exact."""


def _equated(atom: Atom) -> tuple[str, float] | None:
    match atom:
        case Comparison(Variable(name), "==" | "!=", Number(bound)):
            return name, bound
    return None
