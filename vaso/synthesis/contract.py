"""The two games of a contract, and what of it lies outside GR(1).

A rule that is not a recurrence property by its form is replaced by a weaker one where the sensors'
victory is to be shown, and by a stronger one where the robot's is; assumptions the other way round.
Then either victory says the same about the contract as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from vaso.errors import FormulaError
from vaso.ltl import FALSE, TRUE, Formula, nnf, simplify, size
from vaso.skill import Rule
from vaso.synthesis.alphabet import Alphabet
from vaso.synthesis.arena import Arena
from vaso.synthesis.fragment import is_recurrence, stronger, weaker
from vaso.synthesis.game import Game
from vaso.synthesis.monitor import Monitor, monitor

__all__ = ["Contract", "Watched"]

MAX_SIZE = 300
"""Formulas with more nodes are left outside."""


@dataclass(frozen=True)
class Watched:
    """A rule with its monitors.

    Attributes:
        rule: The rule or assumption.
        reason: Why it is outside GR(1); empty where it is not.
    """

    rule: Rule
    reason: str = ""


class Contract:
    """Builds the games of some rules.

    Args:
        alphabet: What sensors and robot can do.
        rules: The rules.
        assumptions: The assumptions.
        deadline: When to give up, on the clock ``time.monotonic``.
    """

    def __init__(
        self,
        alphabet: Alphabet,
        rules: Sequence[Rule],
        assumptions: Sequence[Rule],
        deadline: float,
    ) -> None:
        self.alphabet, self.rules, self.assumptions = alphabet, list(rules), list(assumptions)
        self._deadline = deadline
        self._known: dict[tuple[int, Formula], Monitor | str] = {}

    def with_rules(
        self, rules: Sequence[Rule], assumptions: Sequence[Rule] | None = None
    ) -> Contract:
        """The games of other rules over the same atoms."""
        chosen = self.assumptions if assumptions is None else assumptions
        other = Contract(self.alphabet, rules, chosen, self._deadline)
        other._known = self._known
        return other

    def to_lose(self, arena: Arena | None) -> Game | None:
        """A game in an arena whose loss shows that nothing there keeps the rules."""
        return self._game(arena, weaker, TRUE, stronger, FALSE)

    def to_win(self, arena: Arena | None) -> Game | None:
        """A game in an arena whose victory shows that something there keeps the rules."""
        return self._game(arena, stronger, FALSE, weaker, TRUE)

    def outside(self) -> list[Watched]:
        """The rules and assumptions that are replaced."""
        arena = self.alphabet.own or self.alphabet.conceivable
        found = [Watched(r, self._reason(r.formula, arena)) for r in self.rules + self.assumptions]
        return [w for w in found if w.reason]

    def _reason(self, formula: Formula, arena: Arena | None) -> str:
        if size(formula) > MAX_SIZE:
            return "it is too long"
        if not is_recurrence(simplify(nnf(formula))):
            return "it speaks of what holds from some time on for ever"
        built = self._monitor(formula, arena) if arena else ""
        return built if isinstance(built, str) else ""

    def _game(
        self,
        arena: Arena | None,
        of_rules: Callable[[Formula], Formula],
        no_rule: Formula,
        of_assumptions: Callable[[Formula], Formula],
        no_assumption: Formula,
    ) -> Game | None:
        if arena is None:
            return None
        assumptions = [
            self._within(r.formula, arena, of_assumptions, no_assumption) for r in self.assumptions
        ]
        rules = [self._within(r.formula, arena, of_rules, no_rule) for r in self.rules]
        watched = [m.formula for m in (*assumptions, *rules)]
        texts = tuple(r.text for r in self.rules)
        return Game(arena.reduced(watched), tuple(assumptions), tuple(rules), texts)

    def _within(
        self,
        formula: Formula,
        arena: Arena,
        replace: Callable[[Formula], Formula],
        otherwise: Formula,
    ) -> Monitor:
        """The monitor of a formula, or of what replaces it, or of a constant at the worst."""
        candidates = [formula, replace(formula)] if size(formula) <= MAX_SIZE else []
        for candidate in (*candidates, otherwise):
            built = self._monitor(candidate, arena)
            if isinstance(built, Monitor):
                return built
        raise AssertionError("a constant has a monitor")

    def _monitor(self, formula: Formula, arena: Arena) -> Monitor | str:
        """The monitor of a formula over the letters of an arena, or why it has none."""
        key = (id(arena), formula)
        if key not in self._known:
            try:
                letters = arena.letters(formula)
                self._known[key] = monitor(formula, letters, deadline=self._deadline)
            except FormulaError as error:
                self._known[key] = error.message
        return self._known[key]
