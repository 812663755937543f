"""A formula watched while a behaviour goes on, by formula progression.

The answer is three-valued, about all the ways in which the behaviour can still go on: *satisfied*
(all of them satisfy the formula), *violated* (none does), *open* (Bauer, Leucker & Schallhart,
Runtime Verification for LTL and TLTL, 2011). For safety formulas and their negations it is exact;
for others, "satisfied" and "violated" are right and "open" may last longer than it must.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

from vaso.errors import FormulaError
from vaso.ltl import (
    Atom,
    Comparison,
    Formula,
    Proposition,
    atoms,
    compare,
    depth,
    is_syntactically_safe,
    negate,
    nnf,
    simplify,
)
from vaso.ltl.past import PastMemory, value_in
from vaso.ltl.progression import DONE, LOST, Demand, Progression, demand

__all__ = ["Letter", "Monitor", "Partial", "Situation", "Truth", "letter_of"]

MAX_DEPTH = 60
MAX_ATOMS = 6
MAX_SITUATIONS = 100
"""Bounds within which all situations are looked at beforehand, for the exact answer."""

MAX_UNKNOWN = 10
"""Values that may be missing in a step: every combination of them is followed."""

MAX_REMEMBERED = 20_000
"""Steps that are remembered, so that a long run does not use ever more memory."""

Letter: TypeAlias = tuple[bool, ...]
"""The values of a monitor's atoms in a step."""

Partial: TypeAlias = tuple[bool | None, ...]
"""The same where some values are not known."""


class Truth(StrEnum):
    """What is known of a formula on a behaviour that goes on."""

    SATISFIED = "satisfied"
    VIOLATED = "violated"
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class Situation:
    """Where a monitor is after some steps.

    Attributes:
        past: The memory of the past operators.
        demanded: What must hold from the next step on.
    """

    past: tuple[bool, ...]
    demanded: Demand


_WON, _LOST = Situation((), DONE), Situation((), LOST)


class Monitor:
    """Watches one formula. It has no state of its own: situations are values.

    Args:
        formula: The formula.

    Attributes:
        formula: The formula.
        atoms: Its atoms, in the order of letters.
        start: The situation before the first step.
        exact: True where ``truth`` is exact, and not only right.

    Raises:
        FormulaError: It is too deep, or looks ahead from inside a past operator.
    """

    def __init__(self, formula: Formula) -> None:
        self.formula = formula
        normal = simplify(nnf(formula))
        if depth(normal) > MAX_DEPTH:
            raise FormulaError(
                f"the formula is nested more than {MAX_DEPTH} deep and cannot be watched"
            )
        self.atoms: tuple[Atom, ...] = tuple(sorted(atoms(formula), key=str))
        opposites = [(a, _opposite(a)) for a in self.atoms]
        known = set(self.atoms)  # which may hold both x == 0 and x != 0, with values of their own
        self._opposites = [(a, o) for a, o in opposites if o is not None and o not in known]
        self._memory = PastMemory(normal)
        self._after: dict[tuple[Situation, Letter], Situation] = {}
        self._steps: dict[tuple[Letter, tuple[bool, ...]], tuple[Progression, tuple[bool, ...]]]
        self._steps = {}
        self._truth: dict[Situation, Truth] = {}
        self.start = self._situation(self._memory.initial, demand(normal))
        self._refuse_future_in_past()
        self.exact = self._classify(normal)

    # --- stepping --------------------------------------------------------------------------------

    def after(self, here: Situation, letter: Letter) -> Situation:
        """The situation after a step.

        Args:
            here: The situation before it.
            letter: The values of :attr:`atoms` in it.

        Raises:
            FormulaError: The formula has too many alternatives to be watched.
        """
        known = self._after.get((here, letter))
        if known is None:
            if len(self._after) > MAX_REMEMBERED:
                self._after.clear()
                self._steps.clear()
            known = self._after[here, letter] = self._next(here, letter)
        return known

    def truth(self, here: Situation) -> Truth:
        """What is known in a situation."""
        if here.demanded == LOST:
            return Truth.VIOLATED
        if here.demanded == DONE:
            return Truth.SATISFIED
        return self._truth.get(here, Truth.OPEN)

    def all_after(self, here: Iterable[Situation], letter: Partial) -> frozenset[Situation]:
        """Every situation that is possible after a step of which not everything is known.

        Raises:
            FormulaError: Too much is not known.
        """
        if letter.count(None) > MAX_UNKNOWN:
            raise FormulaError(f"{letter.count(None)} things that it speaks of are not known")
        letters = completions(letter)
        return frozenset(self.after(s, full) for s in here for full in letters)

    def _next(self, here: Situation, letter: Letter) -> Situation:
        if here.demanded in (LOST, DONE):
            return here
        progression, past = self._progression(letter, here.past)
        return self._situation(past, progression.after(here.demanded))

    def _situation(self, past: tuple[bool, ...], demanded: Demand) -> Situation:
        if demanded == LOST:
            return _LOST
        return _WON if demanded == DONE else Situation(past, demanded)

    def _progression(
        self, letter: Letter, past: tuple[bool, ...]
    ) -> tuple[Progression, tuple[bool, ...]]:
        if (letter, past) not in self._steps:
            now = dict(zip(self.atoms, letter, strict=True))
            now.update({o: not now[a] for a, o in self._opposites})
            values, kept = self._memory.read(past, now)
            self._steps[letter, past] = Progression(lambda f: value_in(f, now, values)), kept
        return self._steps[letter, past]

    def _refuse_future_in_past(self) -> None:
        try:
            self._next(self.start, (False,) * len(self.atoms))
        except (KeyError, AssertionError) as error:
            raise FormulaError(
                "the formula looks ahead from inside a past operator and cannot be watched"
            ) from error

    # --- what every continuation leads to --------------------------------------------------------

    def _classify(self, normal: Formula) -> bool:
        """Find the situations whose outcome is settled though it does not show yet."""
        graph = self._explored()
        if graph is None:
            return False
        safe, cosafe = is_syntactically_safe(normal), is_syntactically_safe(negate(normal))
        doomed = _unavoidable(graph, _LOST)
        sure = _unavoidable(graph, _WON)
        doomed |= {*graph} - _leading_to(graph, _WON) if cosafe else set()
        sure |= {*graph} - _leading_to(graph, _LOST) if safe else set()
        self._truth.update(dict.fromkeys(doomed, Truth.VIOLATED))
        self._truth.update(dict.fromkeys(sure, Truth.SATISFIED))
        return safe or cosafe

    def _explored(self) -> dict[Situation, set[Situation]] | None:
        """Every situation with those that can follow it; None where there are too many."""
        if len(self.atoms) > MAX_ATOMS:
            return None
        letters = completions((None,) * len(self.atoms))
        graph: dict[Situation, set[Situation]] = {}
        todo = [self.start]
        while todo:
            here = todo.pop()
            if here in graph:
                continue
            if len(graph) >= MAX_SITUATIONS:
                return None
            try:
                graph[here] = {self.after(here, letter) for letter in letters}
            except FormulaError:
                return None
            todo += graph[here]
        return graph


def letter_of(watched: Sequence[Atom], labels: Mapping[str, bool | float]) -> Partial:
    """The values of some atoms in a step; None for what the step does not say.

    Args:
        watched: The atoms.
        labels: The propositions that are known, with their values.
    """
    return tuple(_value(atom, labels) for atom in watched)


def completions(letter: Partial) -> list[Letter]:
    """Every letter that agrees with what is known."""
    return list(itertools.product(*((v,) if v is not None else (False, True) for v in letter)))


def _value(atom: Atom, labels: Mapping[str, bool | float]) -> bool | None:
    if isinstance(atom, Proposition):
        value = labels.get(atom.name)
        return value if isinstance(value, bool) else None
    try:
        return compare(atom, labels)
    except FormulaError:  # a number is missing, not finite, or a term divides by zero
        return None


def _opposite(atom: Atom) -> Comparison | None:
    """The comparison that the negation of a comparison is in normal form."""
    opposite = nnf(negate(atom))
    return opposite if isinstance(opposite, Comparison) else None


def _unavoidable(graph: Mapping[Situation, set[Situation]], end: Situation) -> set[Situation]:
    """The situations from which every way leads to the end."""
    found = {end} & graph.keys()
    while more := {s for s, after in graph.items() if after <= found} - found:
        found |= more
    return found


def _leading_to(graph: Mapping[Situation, set[Situation]], end: Situation) -> set[Situation]:
    """The situations from which some way leads to the end."""
    found = {end} & graph.keys()
    while more := {s for s, after in graph.items() if after & found} - found:
        found |= more
    return found
