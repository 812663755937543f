"""Read in a snapshot of the sandbox what the future can look at."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from typing import Any, TypeAlias

from vaso.plan.abstraction.fields import FIRST
from vaso.plan.abstraction.forms import (
    CLOCK,
    EXACT,
    GLOBAL,
    UNSEEN,
    WALL,
    Bound,
    Form,
    Interval,
    Var,
)
from vaso.plan.abstraction.layout import Cell, Layout, Snapshot
from vaso.plan.abstraction.relevance import Relevance
from vaso.plan.abstraction.scopes import NotAnalysableError

Number: TypeAlias = int | float | Fraction
_Valued: TypeAlias = tuple[Number, Number, Bound, Bound, tuple[Number, ...]]

MARGIN = Fraction(1, 10**6)
"""How near to a constant, relative to it or absolute, a value may be for rounding to matter."""

_SEEN, _UNSEEN = "number", "dead"


@dataclass(frozen=True, slots=True)
class View:
    """A snapshot up to what cannot be told apart.

    Attributes:
        base: Everything but the plan's numbers.
        forms: For each form that matters: its value without the clock, its rate with the clock, the
            constants that it is compared with, and the numbers that it is made of where rounding
            may depend on them.
        exact: Identity of the snapshot itself: the base and all of the plan's numbers.
    """

    base: bytes
    forms: tuple[_Valued, ...]
    exact: bytes

    def at(self, now: float) -> tuple[Hashable, ...]:
        """The identity at a time: equal identities behave alike from then on."""
        if not self.forms:
            return (self.base,)
        clock = _wall(now)
        return (self.base, *(_seen(form, clock) for form in self.forms))


def _seen(form: _Valued, clock: Fraction) -> Hashable:
    value, rate, low, high, numbers = form
    if rate:
        value += rate * clock
    if value > high:
        return "above"
    return "below" if value < low else numbers or value


@lru_cache(maxsize=1_000)
def _wall(now: float) -> Fraction:
    return Fraction(now) + WALL


@cache
def _widened(interval: Interval) -> Interval:
    """Values near to a bound are kept, since a program may compute them on the other side."""
    low, high = interval
    return low - _margin(low), high + _margin(high)


def _margin(bound: Bound) -> Fraction:
    return Fraction(0) if isinstance(bound, float) else MARGIN * max(Fraction(1), abs(bound))


class Quotient:
    """Views of the snapshots of one plan.

    Args:
        relevance: What matters where.
        file: What the sandbox calls the plan's text.
    """

    def __init__(self, relevance: Relevance, file: str) -> None:
        self.relevance = relevance
        self._file = file
        self._layout: Layout | None = None
        self._rounding: dict[Form, bool] = {}

    def check_clock(self, file: str, call: tuple[int, int]) -> None:
        """Check that a call that asks for the time is known to do so.

        Raises:
            NotAnalysableError: It is not: the analysis has taken its value for one that stays.
        """
        if file == self._file and call not in self.relevance.clocks:
            raise NotAnalysableError("a clock that the analysis does not know")

    def view(self, snapshot: Snapshot) -> View | None:
        """What the future can look at; None where that is not known.

        Raises:
            NotAnalysableError: The plan stops at a call that the analysis does not know as such.
        """
        if snapshot.file != self._file:
            return None
        if self._layout is None:
            self._layout = Layout(snapshot, self.relevance, self._file)
        at = self._layout.here(snapshot)
        wanted = self.relevance.at.get((at, snapshot.call))
        if wanted is None or snapshot.call in self.relevance.clocks:
            raise NotAnalysableError("a call that the analysis does not know")
        places = self._layout.places(snapshot)
        if places is None:
            return None
        cells = {var: _cell(snapshot, place) for var, place in places.items()}
        running = {var[0] for var in cells} | {GLOBAL, CLOCK[0]} | self._layout.running(snapshot)
        running |= {single.number for single in self.relevance.fields.classes}
        found: list[_Valued] = []
        alive: set[Var] = set()
        for form, interval in wanted.items():
            if all(var[0] in running for var, _ in form):
                alive.update(var for var, _ in form)
                for value in _valued(form, interval, cells):
                    found.append(value if self._rounds(form) else (*value[:4], ()))
        base = _base(snapshot, places, cells, alive)
        numbers = [None if _is_reference(cell) else cell for cell in cells.values()]
        return View(base, tuple(found), _digest([base, numbers]))

    def _rounds(self, form: Form) -> bool:
        """True if equal values of a form may behave otherwise when they come from other numbers.

        Sums of decimals round in one place and not in another. Times lie beside all decimals, so
        rounding does not matter to what is compared with them.
        """
        known = self._rounding.get(form)
        if known is None:
            held = {var for var, _ in form}
            whole = held <= self.relevance.whole
            known = self._rounding[form] = self.relevance.timed.isdisjoint(held) and not whole
        return known


def _valued(form: Form, interval: Interval, cells: Mapping[Var, Any]) -> Iterator[_Valued]:
    """A form's value; nothing for one that no path can look at from here."""
    if interval == UNSEEN:
        return
    value: Number = 0
    rate: Number = 0
    numbers: list[Number] = []
    for var, coefficient in form:
        if var == CLOCK:
            rate = coefficient
            continue
        cell = cells.get(var)
        number = _number(cell)
        if number is not None:
            numbers.append(number)
            value = number if len(form) == 1 else value + coefficient * Fraction(number)
        elif _no_number(cell) if var in cells else var[0] <= FIRST:
            return  # reading it, or computing with it, raises before anything is compared
        else:
            # Its value is part of the base, so the rest of the form is looked at by itself.
            interval = EXACT
    yield value, rate, *_widened(interval), tuple(numbers) if len(numbers) > 1 else ()


def _no_number(cell: Any) -> bool:
    return cell in ("U", "O") or (isinstance(cell, dict) and "T" in cell)


def _number(cell: Any) -> int | float | None:
    """The number in a cell; None for anything else, also for a truth value."""
    if not isinstance(cell, dict) or len(cell) != 1:
        return None
    ((tag, value),) = cell.items()
    if tag == "I" or (tag == "F" and math.isfinite(value)):
        return value  # type: ignore[no-any-return]
    return None


def _cell(snapshot: Snapshot, place: Cell) -> Any:
    where, index, attribute = place
    if where == "cell":
        return snapshot.heap[index]["D"]["K"]
    if where == "object":
        return snapshot.heap[index]["D"]["I"]["A"]["E"][attribute]["V"]
    return snapshot.machine[where][index]


def _base(
    snapshot: Snapshot,
    places: Mapping[Var, Cell],
    cells: Mapping[Var, Any],
    alive: set[Var],
) -> bytes:
    """A digest of everything but the numbers in the variables."""
    kind, pending, machine, scheduler = snapshot.shape[0]
    shape = [None, *snapshot.shape[1:]]
    parts = {**machine, "stack": [*machine["stack"]], "globals": [*machine["globals"]]}
    objects: dict[int, list[Any]] = {}
    for var, (where, index, attribute) in places.items():
        mark = _mark(cells[var], var in alive)
        if mark is None:
            continue
        if where == "cell":
            shape[1 + snapshot.order[index]] = ["K", mark]
        elif where == "object":
            number = 1 + snapshot.order[index]
            if number not in objects:
                tag, (rest, kind_of) = shape[number]
                objects[number] = [*rest["A"]["E"]]
                rest = {**rest, "A": {**rest["A"], "E": objects[number]}}
                shape[number] = [tag, [rest, kind_of]]
            objects[number][attribute] = {**objects[number][attribute], "V": mark}
        else:
            parts[where][index] = mark
    shape[0] = [kind, pending, parts, scheduler]
    return _digest(shape)


def _digest(items: Any) -> bytes:
    return hashlib.blake2b(repr(items).encode(), digest_size=16).digest()


def _is_reference(cell: Any) -> bool:
    return isinstance(cell, dict) and "C" in cell


def _mark(cell: Any, alive: bool) -> Any:
    """What stands for a variable's value; None where the value itself does."""
    if _is_reference(cell):
        return None
    if not alive:
        return _UNSEEN
    return None if _number(cell) is None else [_SEEN, *cell]
