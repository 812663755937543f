"""Read in a snapshot of the sandbox what the future can look at."""

from __future__ import annotations

import hashlib
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

from vaso.plan.abstraction.calls import Place, Span
from vaso.plan.abstraction.forms import CLOCK, GLOBAL, UNSEEN, WALL, Form, Interval, Var
from vaso.plan.abstraction.layout import Cell, Layout, Snapshot
from vaso.plan.abstraction.relevance import Relevance
from vaso.plan.abstraction.scopes import NotAnalysableError
from vaso.plan.abstraction.values import Value, Watched, number_in

_SEEN, _UNSEEN = "number", "dead"


@dataclass(frozen=True, slots=True)
class View:
    """A snapshot up to what cannot be told apart.

    Attributes:
        base: Everything but the plan's numbers.
        values: The values of the forms that matter.
        exact: Identity of the snapshot itself: the base and all of the plan's numbers.
    """

    base: bytes
    values: tuple[Value, ...]
    exact: bytes

    def at(self, now: float) -> tuple[Hashable, ...]:
        """The identity at a time: equal identities behave alike from then on."""
        if not self.values:
            return (self.base,)
        clock = _wall(now)
        return (self.base, *(value.seen(clock) for value in self.values))


@lru_cache(maxsize=1_000)
def _wall(now: float) -> Fraction:
    return Fraction(now) + WALL


@dataclass(frozen=True, slots=True)
class _Watching:
    """What the future looks at from a call.

    Attributes:
        forms: The forms whose values it looks at.
        kinds: The variables of which it only asks whether they are numbers, by those that own them.
    """

    forms: list[Watched]
    kinds: list[tuple[frozenset[int], set[Var]]]


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
        self._watched: dict[tuple[Place, Span], _Watching] = {}

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
        watched = self._at(self._layout.here(snapshot), snapshot.call)
        places = self._layout.places(snapshot)
        if places is None:
            return None
        cells = {var: _cell(snapshot, place) for var, place in places.items()}
        running = {var[0] for var in cells} | {GLOBAL, CLOCK[0]} | self._layout.running(snapshot)
        running |= {single.number for single in self.relevance.fields.classes}
        found: list[Value] = []
        alive: set[Var] = set()
        for owners, variables in watched.kinds:
            if owners <= running:
                alive |= variables
        for form in watched.forms:
            if form.owners <= running:
                alive |= form.variables
                found.extend(form.values(cells))
        base = _base(snapshot, places, cells, alive)
        numbers = [None if _is_reference(cell) else cell for cell in cells.values()]
        return View(base, tuple(found), base + repr(numbers).encode())

    def _at(self, place: Place, call: Span) -> _Watching:
        """What the future looks at from a call."""
        known = self._watched.get((place, call))
        if known is None:
            wanted = self.relevance.at.get((place, call))
            if wanted is None or call in self.relevance.clocks:
                raise NotAnalysableError("a call that the analysis does not know")
            known = self._watched[place, call] = self._watching(wanted)
        return known

    def _watching(self, wanted: Mapping[Form, Interval]) -> _Watching:
        kinds: dict[frozenset[int], set[Var]] = {}
        for form, interval in wanted.items():
            if interval == UNSEEN:
                variables = {var for var, _ in form}
                kinds.setdefault(frozenset(v[0] for v in variables), set()).update(variables)
        forms = [
            Watched(form, interval, rounds=self._rounds(form))
            for form, interval in wanted.items()
            if interval != UNSEEN
        ]
        return _Watching(forms, list(kinds.items()))

    def _rounds(self, form: Form) -> bool:
        """True if equal values of a form may behave otherwise when they come from other numbers.

        Sums of decimals round in one place and not in another. Times lie beside all decimals, so
        rounding does not matter to what is compared with them.
        """
        held = {var for var, _ in form}
        return self.relevance.timed.isdisjoint(held) and not held <= self.relevance.whole


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
    *others, stack, globals_ = snapshot.shape[0]
    shape = [None, *snapshot.shape[1:]]
    parts = {"stack": [*stack], "globals": [*globals_]}
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
    shape[0] = [*others, *parts.values()]
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
    return None if number_in(cell) is None else [_SEEN, *cell]
