"""The values of linear forms in a snapshot, as far as the future can tell them apart."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

from vaso.plan.abstraction.fields import FIRST
from vaso.plan.abstraction.forms import CLOCK, EXACT, Bound, Form, Interval, Var

Number: TypeAlias = int | float | Fraction

MARGIN = Fraction(1, 10**6)
"""How near to a constant, relative to it or absolute, a value may be for rounding to matter."""


@dataclass(frozen=True, slots=True)
class Value:
    """A form's value in a snapshot.

    Attributes:
        number: Its value without the clock.
        rate: Its rate with the clock.
        low: The smallest constant that it is compared with, less a margin.
        high: The largest one, and a margin.
        parts: The numbers that it is made of where rounding may depend on them; else empty.
    """

    number: Number
    rate: Number
    low: Bound
    high: Bound
    parts: tuple[Number, ...]

    def seen(self, clock: Fraction) -> Hashable:
        """What the future can tell of it at a time."""
        value = self.number
        if self.rate:
            value += self.rate * clock
        if value > self.high:
            return "above"
        if value < self.low:
            return "below"
        return self.parts or (value.as_integer_ratio() if type(value) is Fraction else value)


class Watched:
    """A form that the future looks at from some call.

    Args:
        form: The form.
        interval: The constants that it is compared with.
        rounds: True if equal values may behave otherwise when they come from other numbers.

    Attributes:
        variables: The form's variables.
        owners: The functions that own them.
    """

    def __init__(self, form: Form, interval: Interval, *, rounds: bool) -> None:
        self.variables = frozenset(var for var, _ in form)
        self.owners = frozenset(var[0] for var in self.variables)
        self._terms = [(var, _plain(factor)) for var, factor in form if var != CLOCK]
        self._rate = next((_plain(factor) for var, factor in form if var == CLOCK), 0)
        self._bounds = _widened(interval)
        self._rounds = rounds
        self._single = len(form) == 1

    def values(self, cells: Mapping[Var, Any]) -> Iterator[Value]:
        """Its value; nothing if no path can look at it from here.

        Args:
            cells: What the plan's variables hold, as the sandbox writes it.
        """
        value: Number = 0
        numbers: list[Number] = []
        low, high = self._bounds
        for var, factor in self._terms:
            number = number_in(cells.get(var))
            if number is not None:
                numbers.append(number)
                value = number if self._single else value + _times(factor, number)
            elif _no_number(cells[var]) if var in cells else var[0] <= FIRST:
                return  # reading it, or computing with it, raises before anything is compared
            else:
                # Its value is part of the base, so the rest of the form is looked at by itself.
                low, high = EXACT
        parts = tuple(numbers) if self._rounds and len(numbers) > 1 else ()
        yield Value(value, self._rate, low, high, parts)


def number_in(cell: Any) -> int | float | None:
    """The number in a cell; None for anything else, also for a truth value."""
    if not isinstance(cell, dict) or len(cell) != 1:
        return None
    ((tag, value),) = cell.items()
    if tag == "I" or (tag == "F" and math.isfinite(value)):
        return value  # type: ignore[no-any-return]
    return None


def _no_number(cell: Any) -> bool:
    return cell in ("U", "O") or (isinstance(cell, dict) and "T" in cell)


def _times(factor: int | Fraction, number: int | float) -> int | Fraction:
    """An exact product (whole numbers are a tenth of the work)."""
    return factor * (number if type(number) is int else Fraction(number))


def _plain(factor: Fraction) -> int | Fraction:
    return factor.numerator if factor.denominator == 1 else factor


def _widened(interval: Interval) -> Interval:
    """Values near to a bound are kept, since a program may compute them on the other side."""
    low, high = interval
    return low - _margin(low), high + _margin(high)


def _margin(bound: Bound) -> Fraction:
    return Fraction(0) if isinstance(bound, float) else MARGIN * max(Fraction(1), abs(bound))
