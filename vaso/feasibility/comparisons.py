"""Numeric comparisons as regions of linear forms.

``2 * x + 1 < 5`` and ``2 > x`` say the same about the form ``x``: it is below 2. The constants that
a form is compared with cut the real line into points and open intervals; which of them a form lies
in is all that a formula can see, and is a handful of booleans in a model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from vaso.feasibility.linear import Row
from vaso.ltl import Comparison
from vaso.ltl.syntax import Arithmetic, Number, Term, Variable
from vaso.ltl.traverse import fold_term

__all__ = ["Bound", "Form", "bound", "forms_of"]

_FLIPPED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}

Coefficients = tuple[tuple[str, Fraction], ...]


@dataclass(frozen=True, slots=True)
class Bound:
    """A comparison, normalised: ``sum(coefficients) OP limit``; the first coefficient is 1.

    Attributes:
        coefficients: Variables in alphabetical order with their coefficients; empty when the
            comparison is between constants.
        op: One of ``<  <=  >  >=  ==  !=``.
        limit: The constant on the right.
        opaque: True when a product or quotient of variables stands as a variable of its own.
    """

    coefficients: Coefficients
    op: str
    limit: Fraction
    opaque: bool = False

    @property
    def constant(self) -> bool | None:
        """The truth value of a comparison between constants, else None."""
        if self.coefficients:
            return None
        below, equal = self.limit > 0, self.limit == 0
        return {
            "<": below,
            "<=": below or equal,
            ">": not below and not equal,
            ">=": not below,
            "==": equal,
            "!=": not equal,
        }[self.op]


@dataclass(frozen=True, slots=True)
class Form:
    """A linear form and the constants that it is compared with.

    Region ``2 * j`` is the open interval below ``limits[j]`` (and above the limit before), region
    ``2 * j + 1`` the point ``limits[j]``, and the last region everything above the last limit.

    Attributes:
        coefficients: Variables with their coefficients.
        limits: The constants, ascending, at least one.
        opaque: True when a coefficient belongs to a product or quotient of variables.
    """

    coefficients: Coefficients
    limits: tuple[Fraction, ...]
    opaque: bool = False

    def rows(self, region: int) -> list[Row]:
        """The region as linear constraints."""
        j, point = divmod(region, 2)
        form = dict(self.coefficients)
        if point:
            return [Row(form, -self.limits[j], "=")]
        rows = []
        if j < len(self.limits):
            rows.append(Row(form, -self.limits[j], "<"))
        if j > 0:
            rows.append(Row({n: -c for n, c in form.items()}, self.limits[j - 1], "<"))
        return rows


def bound(comparison: Comparison) -> Bound:
    """Normalise a comparison."""
    left, right = _linear(comparison.left), _linear(comparison.right)
    difference = left.plus(right, Fraction(-1), "<")
    op, terms = str(comparison.op), sorted(difference.coefficients.items())
    if not terms:
        return Bound((), op, -difference.constant)
    lead = terms[0][1]
    if lead < 0:
        op = _FLIPPED.get(op, op)
    return Bound(
        tuple((name, c / lead) for name, c in terms),
        op,
        -difference.constant / lead,
        any(not _is_name(name) for name, _ in terms),
    )


def _is_name(text: str) -> bool:
    """True for a variable, which may carry its member's name (``jackal.speed``)."""
    return all(part.isidentifier() for part in text.split("."))


def forms_of(bounds: Sequence[Bound]) -> list[Form]:
    """Gather the forms that occur, each with its limits."""
    limits: dict[Coefficients, set[Fraction]] = {}
    for b in bounds:
        if b.coefficients:
            limits.setdefault(b.coefficients, set()).add(b.limit)
    opaque = {b.coefficients for b in bounds if b.opaque}
    return [Form(c, tuple(sorted(limits[c])), c in opaque) for c in sorted(limits)]


def _linear(term: Term) -> Row:
    return fold_term(term, _combine)


def _combine(term: Term, parts: tuple[Row, ...]) -> Row:
    match term:
        case Number(value):
            return Row({}, Fraction(repr(value)), "<")
        case Variable(name):
            return Row({name: Fraction(1)}, Fraction(0), "<")
        case Arithmetic("+", _, _):
            return parts[0].plus(parts[1], Fraction(1), "<")
        case Arithmetic("-", _, _):
            return parts[0].plus(parts[1], Fraction(-1), "<")
        case Arithmetic("*", _, _) if not parts[0].coefficients:
            return _scaled(parts[1], parts[0].constant)
        case Arithmetic("*", _, _) if not parts[1].coefficients:
            return _scaled(parts[0], parts[1].constant)
        case Arithmetic("/", _, _) if not parts[1].coefficients and parts[1].constant:
            return _scaled(parts[0], 1 / parts[1].constant)
    # A product or quotient of variables: its text, which is no identifier, names it.
    return Row({f"({term})": Fraction(1)}, Fraction(0), "<")


def _scaled(row: Row, factor: Fraction) -> Row:
    return Row({}, Fraction(0), "<").plus(row, factor, "<")


def values_of(solution: Mapping[str, Fraction]) -> dict[str, float]:
    """The values of the variables proper, as floating-point numbers."""
    return {n: float(v) for n, v in solution.items() if _is_name(n)}
