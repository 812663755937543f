"""Making a counterexample readable: fewer steps, and sensors that are True only where it matters.

Every candidate is a run of the system on which the formula was evaluated, so shortening can only
replace a counterexample by another one.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from vaso.ltl import Formula
from vaso.plan.transition_system import Guard, TransitionSystem
from vaso.verifiers.base import Lasso
from vaso.verifiers.runs import default_values, follow, violates

__all__ = ["shorten"]

EFFORT = 20_000
"""Steps of runs to evaluate at most, so that a long counterexample costs a fraction of a second."""

_Word: TypeAlias = tuple[tuple[Guard, ...], tuple[Guard, ...]]
"""Sensor values of the prefix and of the loop."""


def shorten(system: TransitionSystem, lasso: Lasso, formula: Formula) -> Lasso:
    """Return a counterexample that is at most as long and has at most as many active sensors."""
    search = _Search(system, formula, lasso)
    while search.effort > 0 and any(search.accepts(word) for word in search.candidates()):
        pass
    return search.best


class _Search:
    """Greedy descent: a candidate that is better, and still violates, becomes the best."""

    def __init__(self, system: TransitionSystem, formula: Formula, lasso: Lasso) -> None:
        self.system, self.formula, self.best = system, formula, lasso
        self.usual = default_values(system)
        self.effort = EFFORT

    def accepts(self, word: _Word) -> bool:
        if self.effort <= 0:
            return False
        found = follow(self.system, *word, limit=2 * len(self.best.run) + 4)
        self.effort -= len(found.run) if found else 2 * len(self.best.run)
        if found is None or self._cost(found) >= self._cost(self.best):
            return False
        if not violates(self.system, found, self.formula):
            return False
        self.best = found
        return True

    def candidates(self) -> Iterator[_Word]:
        """Simpler sensor values, the boldest simplifications first."""
        values = tuple(valuation for _, valuation in self.best.run)
        prefix, loop = values[: self.best.loop_start], values[self.best.loop_start :]
        yield (), (self.usual,)
        yield prefix, (self.usual,)
        yield from ((prefix, (value,)) for value in loop)
        yield from ((shorter, loop) for shorter in _without_parts(prefix))
        yield from ((prefix, shorter) for shorter in _without_parts(loop) if shorter)
        yield from ((quieter, loop) for quieter in self._quieter(prefix))
        yield from ((prefix, quieter) for quieter in self._quieter(loop))

    def _quieter(self, values: tuple[Guard, ...]) -> Iterator[tuple[Guard, ...]]:
        for place, value in enumerate(values):
            active = [name for name in self.usual if value[name] != self.usual[name]]
            options = [active, *([name] for name in active)] if len(active) > 1 else [active]
            for names in options:
                quiet = {**value, **{name: self.usual[name] for name in names}}
                if names:
                    yield (*values[:place], quiet, *values[place + 1 :])

    def _cost(self, lasso: Lasso) -> tuple[int, int]:
        active = sum(v[n] != usual for _, v in lasso.run for n, usual in self.usual.items())
        return len(lasso.run), active


def _without_parts(values: tuple[Guard, ...]) -> Iterator[tuple[Guard, ...]]:
    """Leave out a half, a quarter, ... one step."""
    size = (len(values) + 1) // 2
    while size:
        for start in range(0, len(values), size):
            yield values[:start] + values[start + size :]
        size = size // 2
