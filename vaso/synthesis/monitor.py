"""Deterministic Büchi automata that watch a formula, built by formula progression.

A state holds what is still demanded, and the part of it that must come about in finitely many steps
(everything without ``G``, ``W`` and ``V``, which may stand for ever). Whenever that part has come
about, the state is accepting and the part is taken anew: the breakpoint construction
(Miyano & Hayashi, Alternating Finite Automata on ω-Words, 1984). For a recurrence property this is
exact: if a demand can never be met, then after finitely many steps it is lost, or every part that
is taken contains something that never comes about; if it is met, every part comes about.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from vaso.errors import FormulaError
from vaso.ltl import (
    Atom,
    Comparison,
    Formula,
    atoms,
    depth,
    is_syntactically_safe,
    negate,
    nnf,
    simplify,
)
from vaso.ltl.past import PastMemory, value_in
from vaso.ltl.progression import DONE, LOST, Demand, Progression, demand, only
from vaso.synthesis.fragment import is_guarantee, is_recurrence

__all__ = ["Letter", "Monitor", "monitor"]

Letter = tuple[bool, ...]
"""The values of a monitor's atoms in a step."""

MAX_STATES = 2_000
MAX_DEPTH = 60


@dataclass(frozen=True)
class Monitor:
    """A deterministic Büchi automaton. State 0 is initial.

    A behaviour satisfies the formula exactly when accepting states are visited infinitely often.

    Attributes:
        formula: What it watches.
        atoms: The atoms that it sees, in the order of its letters.
        letters: The letters that can occur.
        after: ``after[state][letter index]`` is the next state.
        accepting: Whether each state is accepting.
        dead: The state from which nothing is accepted, if there is one.
    """

    formula: Formula
    atoms: tuple[Atom, ...]
    letters: tuple[Letter, ...]
    after: tuple[tuple[int, ...], ...]
    accepting: tuple[bool, ...]
    dead: int | None

    @property
    def is_safety(self) -> bool:
        """True when it is enough never to reach the dead state."""
        return all(a != (s == self.dead) for s, a in enumerate(self.accepting))


def monitor(formula: Formula, letters: Iterable[Letter], *, deadline: float) -> Monitor:
    """Build the monitor of a recurrence property.

    Args:
        formula: The formula.
        letters: The letters that can occur, over the formula's atoms ordered by their text.
        deadline: When to give up, on the clock ``time.monotonic``.

    Raises:
        FormulaError: It is no recurrence property by its form, or its monitor is too large.
        TimeoutError: The deadline has passed.
    """
    normal = simplify(nnf(formula))
    if depth(normal) > MAX_DEPTH or not is_recurrence(normal):
        raise FormulaError(f"{formula} is not a recurrence property by its form")
    building = _Building(normal, order(formula), tuple(sorted(set(letters))), deadline)
    after, accepting = building.run()
    return _minimised(Monitor(formula, order(formula), building.letters, after, accepting, None))


def order(formula: Formula) -> tuple[Atom, ...]:
    """The atoms of a formula in the order of its monitor's letters."""
    return tuple(sorted(atoms(formula), key=str))


@dataclass(frozen=True)
class _State:
    past: tuple[bool, ...]
    demanded: Demand
    part: Demand
    accepting: bool = True


class _Building:
    def __init__(
        self,
        formula: Formula,
        names: tuple[Atom, ...],
        letters: tuple[Letter, ...],
        deadline: float,
    ) -> None:
        self.letters = letters
        self._deadline = deadline
        self._memory = PastMemory(formula)
        self._values = [_with_opposites(names, letter) for letter in letters]
        self._steps: dict[tuple[int, tuple[bool, ...]], tuple[Progression, tuple[bool, ...]]] = {}
        self._is_safety = is_syntactically_safe(formula)
        start = demand(formula)
        self._states = [_State(self._memory.initial, start, self._part(start))]

    def run(self) -> tuple[tuple[tuple[int, ...], ...], tuple[bool, ...]]:
        index = {self._states[0]: 0}
        after: list[tuple[int, ...]] = []
        while len(after) < len(self._states):
            if time.monotonic() > self._deadline:
                raise TimeoutError
            row = []
            for letter in range(len(self.letters)):
                reached = self._next(self._states[len(after)], letter)
                if reached not in index:
                    index[reached] = len(self._states)
                    self._states.append(reached)
                row.append(index[reached])
            after.append(tuple(row))
            if len(self._states) > MAX_STATES:
                raise FormulaError("the formula has too many situations to be watched")
        return tuple(after), tuple(s.accepting for s in self._states)

    def _next(self, state: _State, letter: int) -> _State:
        if state.demanded == LOST:
            return _DEAD
        if state.demanded == DONE:
            return _FULFILLED
        progression, past = self._step(letter, state.past)
        demanded = progression.after(state.demanded)
        if demanded == LOST:
            return _DEAD
        if demanded == DONE:
            return _FULFILLED
        part = progression.after(state.part)
        if part == DONE:
            return _State(past, demanded, self._part(demanded))
        return _State(past, demanded, part, accepting=False)

    def _part(self, demanded: Demand) -> Demand:
        """What must come about; nothing in a safety property, which is only ever lost."""
        return DONE if self._is_safety else only(demanded, is_guarantee)

    def _step(self, letter: int, past: tuple[bool, ...]) -> tuple[Progression, tuple[bool, ...]]:
        if (letter, past) not in self._steps:
            now: Mapping[Atom, bool] = self._values[letter]
            values, kept = self._memory.read(past, now)
            step = Progression(lambda f: value_in(f, now, values))
            self._steps[letter, past] = step, kept
        return self._steps[letter, past]


def _with_opposites(names: tuple[Atom, ...], letter: Letter) -> dict[Atom, bool]:
    """The values of atoms, and of the comparisons that negation turns them into."""
    values = dict(zip(names, letter, strict=True))
    for atom in names:
        opposite = nnf(negate(atom))
        if isinstance(opposite, Comparison):
            values[opposite] = not values[atom]
    return values


_DEAD = _State((), LOST, LOST, accepting=False)
_FULFILLED = _State((), DONE, DONE)


def _minimised(found: Monitor) -> Monitor:
    """Merge states that the same letters take to accepting states at the same times."""
    lost = _hopeless(found)
    block = [2 if s in lost else int(a) for s, a in enumerate(found.accepting)]
    while True:
        signatures = [
            (b, *(block[t] for t in row)) for b, row in zip(block, found.after, strict=True)
        ]
        numbers = {s: i for i, s in enumerate(dict.fromkeys(signatures))}
        refined = [numbers[s] for s in signatures]
        if len(set(refined)) == len(set(block)):
            break
        block = refined
    return _quotient(found, refined)


def _hopeless(found: Monitor) -> set[int]:
    """The states from which no accepting state can be reached."""
    hopeful = {s for s, accepting in enumerate(found.accepting) if accepting}
    while more := {s for s, row in enumerate(found.after) if hopeful & {*row}} - hopeful:
        hopeful |= more
    return {*range(len(found.after))} - hopeful


def _quotient(found: Monitor, block: Sequence[int]) -> Monitor:
    first = {b: block.index(b) for b in dict.fromkeys(block)}
    after = tuple(tuple(block[t] for t in found.after[s]) for s in first.values())
    accepting = tuple(found.accepting[s] for s in first.values())
    dead = next((i for i, s in enumerate(first.values()) if s in _hopeless(found)), None)
    return Monitor(found.formula, found.atoms, found.letters, after, accepting, dead)
