"""When a label is true of the robot, and which rules rest on it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from vaso.errors import FormulaError
from vaso.ltl import Formula, propositions, variables
from vaso.ltl.normal import nnf
from vaso.ltl.numbers import compare
from vaso.ltl.syntax import Comparison, Proposition, Unary
from vaso.ltl.traverse import operands, subformulas
from vaso.plan.transition_system import Label, Scalar
from vaso.platforms import Platform, PropositionSpec

__all__ = ["Rules", "is_true", "same", "sensor_domain", "value_text"]

TOLERANCE = 1e-6
"""Numbers that are as close as that are the same: floating-point sums in another order are."""


def same(label: object, truth: Label) -> bool:
    """True where a label is the truth, up to floating-point error."""
    if isinstance(label, bool) or isinstance(truth, bool):
        return label == truth
    if not isinstance(label, int | float):
        return False
    return math.isclose(label, truth, rel_tol=TOLERANCE, abs_tol=TOLERANCE)


def is_true(label: object, reading: Scalar) -> bool:
    """True where the label of an observation is what its sensor says.

    Args:
        label: The label: a truth value, or the reading as it came.
        reading: The sensor's value.
    """
    return label == bool(reading) if isinstance(label, bool) else label == reading


def sensor_domain(spec: PropositionSpec, platform: Platform) -> tuple[Scalar, ...]:
    """The values of the sensor that decides an observation; empty where it has none."""
    known = platform.sensor_of(spec.sensor or "")
    return known.domain if known else ()


def value_text(value: object) -> str:
    """A command's argument as a person writes it."""
    if isinstance(value, tuple | list):
        return f"({', '.join(map(value_text, value))})"
    return repr(value + 0.0) if isinstance(value, float) else repr(value)


@dataclass(frozen=True)
class Rules:
    """What the formulas that are to be verified mention.

    Args:
        formulas: Rules, assumptions and further specifications.
    """

    formulas: tuple[Formula, ...]

    @property
    def names(self) -> frozenset[str]:
        """Every proposition that they mention."""
        return frozenset(n for f in self.formulas for n in (*propositions(f), *variables(f)))

    def hides(self, name: str, says: object, has: Label) -> str:
        """What of a rule seems to hold by the label and does not hold of the robot.

        Args:
            name: The proposition.
            says: Its label.
            has: The truth.

        Returns:
            The comparison or literal of a rule, or an empty string. Rules are monotonic in the
            literals of their negation normal form, so only such a difference can turn a violated
            rule into a PASS.
        """
        if not isinstance(says, bool | int | float):
            return ""
        for literal in self._literals:
            if _holds(literal, name, says) is True and _holds(literal, name, has) is False:
                return str(literal)
        return ""

    @cached_property
    def _literals(self) -> tuple[Formula, ...]:
        """Comparisons, propositions and negated propositions, as the rules depend on them."""
        found: dict[Formula, None] = {}
        for formula in map(nnf, self.formulas):
            above = [f for f in subformulas(formula) if not _is_literal(f)]
            parts = dict.fromkeys(part for node in above for part in operands(node))
            found |= dict.fromkeys(filter(_is_literal, (formula, *parts)))
        return tuple(found)


def _is_literal(formula: Formula) -> bool:
    negated = isinstance(formula, Unary) and formula.op == "!"
    return negated or isinstance(formula, Comparison | Proposition)


def _holds(literal: Formula, name: str, value: Label) -> bool | None:
    """The truth of a literal about one proposition; None where it is about something else."""
    if isinstance(literal, Unary):
        inner = _holds(literal.operand, name, value)
        return None if inner is None else not inner
    values: Mapping[str, Label] = {name: value}
    try:
        if isinstance(literal, Comparison):
            return compare(literal, values)
        return bool(value) if isinstance(literal, Proposition) and literal.name == name else None
    except FormulaError:
        return None
