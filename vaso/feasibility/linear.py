"""Exact linear arithmetic over the rationals, enough to tell whether comparisons fit together.

Fourier-Motzkin elimination: exponential in principle, but the systems here have as many rows as a
contract has comparisons, and the answer is exact where floating point would guess.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

__all__ = ["Row", "independent", "solve"]

ZERO, ONE = Fraction(0), Fraction(1)


@dataclass(frozen=True, slots=True)
class Row:
    """A linear constraint ``sum(coefficients) + constant OP 0``.

    Attributes:
        coefficients: The coefficient of each variable.
        constant: The constant term.
        op: ``<``, ``<=`` or ``=``.
    """

    coefficients: Mapping[str, Fraction]
    constant: Fraction
    op: str

    def of(self, variable: str) -> Fraction:
        """The coefficient of a variable, 0 where it does not occur."""
        return self.coefficients.get(variable, ZERO)

    def plus(self, other: Row, factor: Fraction, op: str) -> Row:
        """This row plus ``factor`` times another."""
        names = [*self.coefficients, *(n for n in other.coefficients if n not in self.coefficients)]
        sums = {n: self.of(n) + factor * other.of(n) for n in names}
        return Row(
            {n: c for n, c in sums.items() if c}, self.constant + factor * other.constant, op
        )

    def holds(self, values: Mapping[str, Fraction]) -> bool:
        """Tell whether values of the variables satisfy the row."""
        total = self.constant + sum(c * values[n] for n, c in self.coefficients.items())
        return total == 0 if self.op == "=" else total < 0 or (self.op == "<=" and total == 0)


def solve(rows: Sequence[Row]) -> dict[str, Fraction] | None:
    """Find values that satisfy every row.

    Returns:
        A value for each variable that occurs, as simple as is easily found, or None if there are
        no such values.
    """
    variable = next((n for r in rows for n in r.coefficients), None)
    if variable is None:
        return {} if all(r.holds({}) for r in rows) else None
    values = solve(_eliminate(rows, variable))
    if values is None:
        return None
    for row in rows:
        for name in row.coefficients:
            if name != variable:
                values.setdefault(name, ZERO)
    values[variable] = _pick([r for r in rows if r.of(variable)], variable, values)
    return values


def _eliminate(rows: Sequence[Row], variable: str) -> list[Row]:
    """Rows without the variable that can be satisfied exactly when the given ones can."""
    pivot = next((r for r in rows if r.op == "=" and r.of(variable)), None)
    if pivot is not None:
        return [
            r.plus(pivot, -r.of(variable) / pivot.of(variable), r.op)
            for r in rows
            if r is not pivot
        ]
    upper = [r for r in rows if r.of(variable) > 0]
    lower = [r for r in rows if r.of(variable) < 0]
    crossed = [
        u.plus(low, -u.of(variable) / low.of(variable), "<" if "<" in (u.op, low.op) else "<=")
        for u in upper
        for low in lower
    ]
    return [r for r in rows if not r.of(variable)] + crossed


def _pick(rows: Iterable[Row], variable: str, values: Mapping[str, Fraction]) -> Fraction:
    """A value within the bounds that the rows leave once the other variables are fixed."""
    low: tuple[Fraction, bool] | None = None
    high: tuple[Fraction, bool] | None = None
    for row in rows:
        rest = sum((c * values[n] for n, c in row.coefficients.items() if n != variable), ZERO)
        bound = -(row.constant + rest) / row.of(variable)
        if row.op == "=":
            return bound
        strict = row.op == "<"
        if row.of(variable) > 0:
            high = min(high or (bound, not strict), (bound, not strict))
        else:
            low = max(low or (bound, strict), (bound, strict))
    return _between(low, high)


def _between(low: tuple[Fraction, bool] | None, high: tuple[Fraction, bool] | None) -> Fraction:
    """A simple value between bounds. ``low`` is (bound, strict), ``high`` (bound, not strict)."""
    if low is None and high is None:
        return ZERO
    if low is None:
        assert high is not None
        return ZERO if high[0] > 0 else high[0] - ONE
    if high is None:
        return ZERO if low[0] < 0 else low[0] + ONE
    if low[0] < 0 < high[0]:
        return ZERO
    return (low[0] + high[0]) / 2


def independent(vectors: Sequence[Mapping[str, Fraction]]) -> bool:
    """Tell whether linear forms are independent: then any values of the forms occur together."""
    basis: list[Row] = []
    for vector in vectors:
        row = Row({n: c for n, c in vector.items() if c}, ZERO, "=")
        for known in basis:
            lead = next(iter(known.coefficients))
            row = row.plus(known, -row.of(lead) / known.of(lead), "=")
        if not row.coefficients:
            return False
        basis.append(row)
    return True
