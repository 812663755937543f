"""The game of a contract: assumptions imply rules, every one watched by its monitor.

The robot wins a play when some assumption's monitor accepts finitely often only, or every rule's
monitor accepts infinitely often: a generalized reactivity game of rank 1, GR(1) (Bloem, Jobstmann,
Piterman, Pnueli & Sa'ar, Synthesis of Reactive(1) Designs, 2012).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from vaso.ltl import Atom
from vaso.synthesis.arena import Arena
from vaso.synthesis.monitor import Letter, Monitor

__all__ = ["Game", "Situation"]

Situation = tuple[int, ...]
"""The state of every monitor: assumptions first, then rules."""


@dataclass(frozen=True)
class Game:
    """A game between the sensors and the robot.

    Attributes:
        arena: What both can do.
        assumptions: Monitors of the assumptions.
        rules: Monitors of the rules.
        texts: The rules as their author wrote them.
    """

    arena: Arena
    assumptions: tuple[Monitor, ...]
    rules: tuple[Monitor, ...]
    texts: tuple[str, ...]

    def only(self, rules: Sequence[int]) -> Game:
        """The same game with some of the rules."""
        kept = tuple(self.rules[i] for i in rules)
        return replace(self, rules=kept, texts=tuple(self.texts[i] for i in rules))

    @property
    def start(self) -> Situation:
        """The situation before state 0."""
        return (0,) * len(self._monitors)

    def after(self, situation: Situation, given: int, done: int) -> Situation:
        """The situation after a state with an input and an output."""
        columns = self._columns(given, done)
        return tuple(
            m.after[s][c] for m, s, c in zip(self._monitors, situation, columns, strict=True)
        )

    def lost(self, situation: Situation) -> list[int]:
        """The rules that are broken for good."""
        own = situation[len(self.assumptions) :]
        return [i for i, (m, s) in enumerate(zip(self.rules, own, strict=True)) if s == m.dead]

    def accepted(self, situation: Situation) -> tuple[bool, ...]:
        """Whether each monitor accepts: assumptions first, then rules."""
        return tuple(m.accepting[s] for m, s in zip(self._monitors, situation, strict=True))

    @cached_property
    def _monitors(self) -> tuple[Monitor, ...]:
        return self.assumptions + self.rules

    @cached_property
    def _numbers(self) -> list[dict[Letter, int]]:
        return [{letter: i for i, letter in enumerate(m.letters)} for m in self._monitors]

    @cached_property
    def _known(self) -> dict[tuple[int, int], tuple[int, ...]]:
        return {}

    def _columns(self, given: int, done: int) -> tuple[int, ...]:
        """The letter that each monitor sees under an input and an output."""
        if (given, done) not in self._known:
            self._known[given, done] = tuple(
                numbers[self.arena.letter(m.atoms, given, done)]
                for m, numbers in zip(self._monitors, self._numbers, strict=True)
            )
        return self._known[given, done]

    def to_json(self) -> dict[str, Any]:
        """Plain data, for the process that solves the game."""
        atoms = sorted({a for m in self._monitors for a in m.atoms}, key=str)
        number = {atom: i for i, atom in enumerate(atoms)}
        return {
            "inputs": len(self.arena.inputs),
            "outputs": len(self.arena.outputs),
            "rest": list(self.arena.rest),
            "usable": list(self.arena.usable),
            "atoms": [_table(self.arena, a) for a in atoms],
            "assumptions": [_monitor(m, number) for m in self.assumptions],
            "rules": [_monitor(m, number) for m in self.rules],
        }


def _table(arena: Arena, atom: Atom) -> dict[str, Any]:
    table = arena.tables[atom]
    return {"input": table.by_input, "output": table.by_output, "both": table.by_both}


def _monitor(monitor: Monitor, number: dict[Atom, int]) -> dict[str, Any]:
    return {
        "atoms": [number[a] for a in monitor.atoms],
        "letters": monitor.letters,
        "after": monitor.after,
        "accepting": monitor.accepting,
        "safety": monitor.is_safety,
    }
