"""One rule as the shield sees it: where its monitor is, and what a forecast would do to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TypeAlias

from vaso.dynamics.interval import Interval, compared, enclose
from vaso.dynamics.rules import invariant, names_in
from vaso.ltl import Atom, Comparison, Formula, Proposition, Unary, nnf
from vaso.monitoring.forecast import Phase
from vaso.monitoring.monitor import (
    Letter,
    Monitor,
    Partial,
    Situation,
    Truth,
    completions,
    letter_of,
)
from vaso.monitoring.tolerance import EXACT, Tolerance
from vaso.plan.transition_system import Label
from vaso.skill import Rule

__all__ = ["Guarded", "Guess"]

Guess: TypeAlias = tuple[bool, ...]
"""What sensors may show in the next state: the values of a rule's atoms that are not known yet."""

Acts: TypeAlias = Callable[[str, Phase, bool], bool | None]
"""Whether an action holds in a phase, the first one or a later one; None where it is no action."""

MAX_UNKNOWN = 6
"""Values that are not known, each of which is looked at by itself; beyond, all at once."""

MAX_REMEMBERED = 5_000
MAX_TURNS = 50
TOLERANCE = 1e-6
"""Differences of bounds that are rounding errors."""


class Guarded:
    """The safety part of a rule, guarded by the shield.

    A comparison that may be read as "throughout the period" is judged by the bounds that hold at
    every instant for every vehicle, and watched by what is measured; other comparisons (such as
    ``altitude == 0``, which no measurement ever is) by the platform's model, from the commands.

    Args:
        rule: The rule.
        safety: Its safety part.
        tolerance: How measured numbers are compared.

    Attributes:
        robust: Whether its comparisons are read as "throughout the period".
        broken: True while the last state has violated it.

    Raises:
        FormulaError: It cannot be watched.
    """

    def __init__(self, rule: Rule, safety: Formula, tolerance: Tolerance = EXACT) -> None:
        self.rule = rule
        self._tolerance = tolerance
        self.monitor = Monitor(nnf(safety))
        self.robust = not isinstance(invariant(safety), str)
        self.broken = False
        self._possible: frozenset[Situation] = frozenset({self.monitor.start})
        self._lost: dict[tuple[frozenset[Situation], tuple[Partial, ...]], frozenset[Guess]] = {}

    @property
    def numbers(self) -> frozenset[str]:
        """The numeric propositions that are read as "throughout the period"."""
        compared_ones = [a for a in self.monitor.atoms if isinstance(a, Comparison)]
        return frozenset(n for a in compared_ones for n in names_in(a) if self.robust)

    # --- the run so far --------------------------------------------------------------------------

    def observe(self, labels: Mapping[str, Label], model: Mapping[str, Label]) -> bool:
        """Take a step; a rule that is violated is watched anew from here. True if it is.

        Args:
            labels: What is true in the state.
            model: The platform's numbers by its model.
        """
        if self.robust:
            letter = self._tolerance.letter(self.monitor.atoms, labels)
        else:
            letter = letter_of(self.monitor.atoms, {**labels, **model})
        reached = self._kept(self.monitor.all_after(self._possible, letter))
        self.broken = not reached
        if self.broken:
            start = frozenset({self.monitor.start})
            reached = self._kept(self.monitor.all_after(start, letter)) or start
        self._possible = reached
        return self.broken

    def _kept(self, situations: frozenset[Situation]) -> frozenset[Situation]:
        return frozenset(s for s in situations if self.monitor.truth(s) is not Truth.VIOLATED)

    @property
    def asks(self) -> list[Formula]:
        """Literals of the formula that must hold in the next state, in one alternative."""
        terms = sorted((t for s in self._possible for t in s.demanded), key=len)
        literals = [f for f in terms[0] if _is_literal(f)] if terms else []
        return sorted(literals, key=str)

    # --- what is to come -------------------------------------------------------------------------

    def letters(self, phases: Sequence[Phase], acts: Acts) -> tuple[Partial, ...]:
        """The values of the rule's atoms in each phase, as far as they can be foretold."""
        return tuple(
            tuple(self._value(atom, phase, acts, index == 0) for atom in self.monitor.atoms)
            for index, phase in enumerate(phases)
        )

    def _value(self, atom: Atom, phase: Phase, acts: Acts, first: bool) -> bool | None:
        if isinstance(atom, Proposition):
            return acts(atom.name, phase, first)
        if not self.robust:
            (value,) = letter_of((atom,), phase.truth)
            return value
        if any(name not in phase.bounds for name in names_in(atom)):
            return None
        return compared(atom, phase.bounds) is True

    def lost(self, letters: tuple[Partial, ...]) -> frozenset[Guess]:
        """What sensors may show next so that the rule may then be lost on the way."""
        key = self._possible, letters
        known = self._lost.get(key)
        if known is None:
            if len(self._lost) > MAX_REMEMBERED:
                self._lost.clear()
            known = self._lost[key] = frozenset(self._losing(letters))
        return known

    def loses_at_once(self, letters: tuple[Partial, ...]) -> bool:
        """Whether the rule may be lost in the next state already, whatever follows it."""
        return bool(self._lost_at_once(letters))

    def loses_surely(self, letters: tuple[Partial, ...]) -> bool:
        """Whether it is lost in the next state, whatever sensors show and numbers will be."""
        first = tuple(
            None if isinstance(atom, Comparison) and not value else value
            for atom, value in zip(self.monitor.atoms, letters[0], strict=True)
        )
        reached = self.monitor.all_after(self._possible, first)
        return all(self.monitor.truth(s) is Truth.VIOLATED for s in reached)

    def _lost_at_once(self, letters: tuple[Partial, ...]) -> set[Letter]:
        """The letters of the next state with which the rule may be lost in it."""
        return {
            _guess(letter, letters[0])
            for letter in completions(letters[0])
            for here in self._possible
            if self.monitor.truth(self.monitor.after(here, letter)) is Truth.VIOLATED
        }

    def _losing(self, letters: tuple[Partial, ...]) -> Iterator[Guess]:
        first, rest = letters[0], letters[1:]
        if first.count(None) > MAX_UNKNOWN:
            if self._may_lose(self.monitor.all_after(self._possible, first), rest or (first,)):
                yield ()
            return
        for letter in completions(first):
            reached = frozenset(self.monitor.after(s, letter) for s in self._possible)
            if self._may_lose(reached, rest or (first,)):
                yield _guess(letter, first)

    def _may_lose(self, here: frozenset[Situation], letters: Sequence[Partial]) -> bool:
        """Whether the rule may be lost under the letters, the last one of which is repeated."""
        seen: set[frozenset[Situation]] = set()
        for turn in range(len(letters) + MAX_TURNS):
            if any(self.monitor.truth(s) is Truth.VIOLATED for s in here):
                return True
            if turn >= len(letters):
                if here in seen:
                    return False
                seen.add(here)
            here = self.monitor.all_after(here, letters[min(turn, len(letters) - 1)])
        return True

    def no_worse(
        self,
        phases: Sequence[Phase],
        letters: tuple[Partial, ...],
        safe_phases: Sequence[Phase],
        safe_letters: tuple[Partial, ...],
    ) -> bool:
        """Whether one forecast is no worse for the rule than that of the safe command.

        That is so where numbers come no nearer to their limits, and actions are the same or at
        least no more likely to lose the rule at once; never where that is sure.
        """
        if self.loses_surely(letters):
            return False
        keeps = self._lost_at_once(letters) <= self._lost_at_once(safe_letters)
        for index, atom in enumerate(self.monitor.atoms):
            if isinstance(atom, Comparison) and self.robust:
                worst, safe = _excess(atom, phases), _excess(atom, safe_phases)
                if worst > safe + TOLERANCE:
                    return False
            elif letters[0][index] != safe_letters[0][index] and not keeps:
                return False
        return True

    def end(self, phases: Sequence[Phase]) -> float:
        """By how much a comparison may still fail once the first period is over; negative is none.

        It is infinite where the rule is not only about numbers.
        """
        compared_only = [a for a in self.monitor.atoms if isinstance(a, Comparison)]
        if not self.robust or len(compared_only) != len(self.monitor.atoms):
            return math.inf
        return max(_excess(atom, phases[1:] or phases) for atom in compared_only)

    def troubles(self, phases: Sequence[Phase]) -> Iterator[tuple[Comparison, int]]:
        """Comparisons that may become false, each with the phase in which they first may."""
        for atom in self.monitor.atoms:
            if not isinstance(atom, Comparison) or not self.robust:
                continue
            for index, phase in enumerate(phases):
                known = all(name in phase.bounds for name in names_in(atom))
                if known and compared(atom, phase.bounds) is not True:
                    yield atom, index
                    break


def _excess(atom: Comparison, phases: Sequence[Phase]) -> float:
    """By how much a comparison may fail at most; for equations, how far the sides may differ."""
    known = [p.bounds for p in phases if all(name in p.bounds for name in names_in(atom))]
    return max((_gap(atom, bounds) for bounds in known), default=-math.inf)


def _gap(atom: Comparison, bounds: Mapping[str, Interval]) -> float:
    left, right = enclose(atom.left, bounds), enclose(atom.right, bounds)
    above, below = left[1] - right[0], right[1] - left[0]
    match atom.op:
        case "<" | "<=":
            return above
        case ">" | ">=":
            return below
    return max(above, below)


def _guess(letter: Letter, partial: Partial) -> Guess:
    """The part of a letter that was not known."""
    return tuple(v for v, known in zip(letter, partial, strict=True) if known is None)


def _is_literal(formula: Formula) -> bool:
    match formula:
        case Unary("!", Proposition()) | Proposition():
            return True
    return False
