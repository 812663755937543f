"""Comparisons over a whole period: true at every instant, false at some instant, or not known."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from vaso.dynamics.interval import EVERYTHING, Interval, compared, hull
from vaso.dynamics.unfold import Node
from vaso.ltl import Comparison
from vaso.plan.transition_system import State

__all__ = ["Instants"]

PIECES = 16
"""Into so many pieces a period is cut where bounds over all of it are too wide."""

LATER = (1, 2, 3, 4, 6, 8, 12, 16, 32, 64)
"""Further instants, in periods, where a command stays in force for ever."""


class Instants:
    """The numbers of a node's period.

    Args:
        node: The node.
        state: Its control state, for numbers about set-points.
        dt: Control period in seconds.
        names: The numeric propositions of interest.
    """

    def __init__(self, node: Node, state: State, dt: float, names: Sequence[str]) -> None:
        self.node, self.dt, self.names = node, dt, names
        self.fixed = {name: _point(state.labels.get(name)) for name in names}

    def values(self, begin: float, end: float) -> dict[str, Interval]:
        """Bounds on the numbers from one time in the period to another."""
        found = self.node.period.values(begin, end)
        return {name: found.get(name, self.fixed[name]) for name in self.names}

    def at_sample(self) -> dict[str, Interval]:
        """The numbers at the end of the period, which is the first of many where it never ends."""
        end = self.dt if self.node.duration else 0.0
        return self.values(end, end)

    def always(self, comparisons: Sequence[Comparison]) -> tuple[list[bool], dict[str, Interval]]:
        """Which comparisons surely hold at every instant, and bounds over all instants."""
        whole = self.values(0.0, self.node.duration)
        sure = [compared(c, whole) is True for c in comparisons]
        if all(sure) or self.node.duration == 0.0:
            return sure, whole
        pieces = [self.values(a, b) for a, b in pairwise(self._times())]
        sure = [
            s or all(compared(c, p) is True for p in pieces)
            for s, c in zip(sure, comparisons, strict=True)
        ]
        return sure, {name: hull(p[name] for p in pieces) for name in self.names}

    def violations(self, comparison: Comparison) -> Iterator[tuple[float, Mapping[str, Interval]]]:
        """Instants at which a comparison is surely false, with the numbers there."""
        if compared(comparison, self.values(0.0, self.node.duration)) is True:
            return
        for time in self._times():
            if math.isfinite(time) and (time > 0.0 or self.node.duration == 0.0):
                values = self.values(time, time)
                if compared(comparison, values) is False:
                    yield time, values

    def _times(self) -> list[float]:
        """The ends of the pieces, from 0 to the end of the period."""
        if self.node.duration == 0.0:
            return [0.0]
        times = [self.dt * i / PIECES for i in range(PIECES + 1)]
        if math.isinf(self.node.duration):
            times += [self.dt * n for n in LATER[1:]] + [math.inf]
        return times


def _point(label: bool | float | None) -> Interval:
    """What is known of a number about set-points: it does not change inside a period."""
    if label is None or isinstance(label, bool):
        return EVERYTHING
    return float(label), float(label)
