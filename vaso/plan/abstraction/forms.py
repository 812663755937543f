"""Linear forms over a plan's variables, and what the future compares them with."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeAlias

Var: TypeAlias = tuple[int, str]
"""A variable: the number of the function that owns it (``GLOBAL`` for the module), and its name."""

GLOBAL = -1
CLOCK: Var = (-2, "clock")
"""What ``time.time()`` returns."""

WALL = Fraction(2**17)
"""What ``time.time()`` is ahead of ``time.monotonic()``, so that nobody takes one for the other."""

Bound: TypeAlias = Fraction | float
"""A constant, or an infinity."""

Form: TypeAlias = tuple[tuple[Var, Fraction], ...]
"""A linear form without constant part, sorted; the first coefficient is 1."""

Interval: TypeAlias = tuple[Bound, Bound]
"""Smallest and largest constant that the future may compare a form with."""

EXACT: Interval = (-math.inf, math.inf)
UNSEEN: Interval = (math.inf, -math.inf)
"""The value is not looked at, only whether it is a number."""

WIDEN_AFTER = 3
MAX_FORMS = 24


@dataclass(frozen=True, slots=True)
class Affine:
    """A linear form with a constant part, as an expression's value.

    Attributes:
        terms: Coefficients, none of them 0.
        constant: The constant part.
    """

    terms: Mapping[Var, Fraction]
    constant: Fraction = Fraction(0)

    @staticmethod
    def of(var: Var) -> Affine:
        """The value of a variable."""
        return Affine({var: Fraction(1)})

    def plus(self, other: Affine, factor: Fraction) -> Affine:
        """This form plus another one times a factor."""
        terms = dict(self.terms)
        for var, coefficient in other.terms.items():
            terms[var] = terms.get(var, Fraction(0)) + factor * coefficient
        kept = {v: c for v, c in terms.items() if c}
        return Affine(kept, self.constant + factor * other.constant)


def normal(value: Affine, interval: Interval) -> tuple[Form, Interval] | None:
    """A form and the constants it is compared with, scaled; None for a form without variables.

    ``value`` compared with the constants of ``interval`` is the normal form compared with the
    constants that are returned.
    """
    if not value.terms:
        return None
    terms = sorted(value.terms.items())
    lead = terms[0][1]
    low, high = ((_shift(b, value.constant)) for b in interval)
    if interval[0] > interval[1]:
        low, high = UNSEEN
    elif lead < 0:
        low, high = _scaled(high, lead), _scaled(low, lead)
    else:
        low, high = _scaled(low, lead), _scaled(high, lead)
    return tuple((v, c / lead) for v, c in terms), (low, high)


def _shift(bound: Bound, constant: Fraction) -> Bound:
    return bound if isinstance(bound, float) else bound - constant


def _scaled(bound: Bound, lead: Fraction) -> Bound:
    if isinstance(bound, float):
        return bound if lead > 0 else -bound
    return bound / lead


@dataclass(slots=True)
class Atoms:
    """The forms that the future looks at in one program point.

    Attributes:
        bounds: The constants that each form is compared with.
        grown: How often each form's constants have grown.
        spanned: True once there were too many forms: a basis of their span then stands for them,
            and all of it is looked at exactly.
    """

    bounds: dict[Form, Interval] = field(default_factory=dict)
    grown: dict[Form, int] = field(default_factory=dict)
    spanned: bool = False

    def add(self, form: Form, interval: Interval) -> list[Form]:
        """Add a form; the forms that this changes."""
        known = self.bounds.get(form)
        if interval == UNSEEN:
            if known is None:
                self.bounds[form] = UNSEEN
            return [form] if known is None else []
        if self.spanned:
            return self._extend(form)
        if known is None or known == UNSEEN:
            self.bounds[form] = interval
            return [form] if len(self._compared()) <= MAX_FORMS else self._span()
        low, high = min(known[0], interval[0]), max(known[1], interval[1])
        if (low, high) == known:
            return []
        count = self.grown[form] = self.grown.get(form, 0) + 1
        if count > WIDEN_AFTER:
            low = low if low == known[0] else -math.inf
            high = high if high == known[1] else math.inf
        self.bounds[form] = (low, high)
        return [form]

    def _compared(self) -> list[Form]:
        """The forms whose values are looked at."""
        return [form for form, interval in self.bounds.items() if interval != UNSEEN]

    def _span(self) -> list[Form]:
        forms = self._compared()
        self.bounds = {form: i for form, i in self.bounds.items() if i == UNSEEN}
        self.spanned = True
        for form in forms:
            self._extend(form)
        return self._compared()

    def _extend(self, form: Form) -> list[Form]:
        rest = dict(form)
        for known in self._compared():
            factor = rest.get(known[0][0], Fraction(0))
            if factor:
                rest = dict(Affine(rest).plus(Affine(dict(known)), -factor).terms)
        scaled = normal(Affine(rest), EXACT)
        if scaled is None:
            return []
        self.bounds[scaled[0]] = EXACT
        return [scaled[0]]
