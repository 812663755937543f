"""Making a counterexample readable: fewer steps, and sensors that are True only where it matters.

Every candidate is a run of the system on which the formula was evaluated, so shortening can only
replace a counterexample by another one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
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
        start = self.best.loop_start
        prefix, loop = values[:start], values[start:]
        yield (), (self.usual,)
        yield prefix, (self.usual,)
        yield from ((prefix, (value,)) for value in _distinct(loop))
        yield from self._quieter(values, start, slice(0, len(values)))
        for part in _parts(len(prefix)):
            yield prefix[: part.start] + prefix[part.stop :], loop
        for part in _parts(len(loop)):
            if part.stop - part.start < len(loop):
                yield prefix, loop[: part.start] + loop[part.stop :]
        for part in _parts(len(values)):
            yield from self._quieter(values, start, part)

    def _quieter(self, values: tuple[Guard, ...], start: int, part: slice) -> Iterator[_Word]:
        """All sensors at their usual value in a part of the run, then one sensor at a time."""
        active = [
            name
            for name, usual in self.usual.items()
            if any(v[name] != usual for v in values[part])
        ]
        options = [active, *([name] for name in active)] if len(active) > 1 else [active]
        for names in filter(None, options):
            usual = {name: self.usual[name] for name in names}
            quiet = tuple({**value, **usual} for value in values[part])
            word = values[: part.start] + quiet + values[part.stop :]
            yield word[:start], word[start:]

    def _cost(self, lasso: Lasso) -> tuple[int, int]:
        active = sum(v[n] != usual for _, v in lasso.run for n, usual in self.usual.items())
        return len(lasso.run), active


def _distinct(values: Iterable[Guard]) -> list[Guard]:
    return list({frozenset(value.items()): value for value in values}.values())


def _parts(length: int) -> Iterator[slice]:
    """The whole of a sequence, its halves, its quarters, ... its elements."""
    size = length
    while size:
        for start in range(0, length, size):
            yield slice(start, min(start + size, length))
        size = (size + 1) // 2 if size > 1 else 0
