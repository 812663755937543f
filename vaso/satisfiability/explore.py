"""Search for a behaviour: from promise to promise, until the duties repeat.

A behaviour is found in *cycles*. A cycle starts in some state and ends when every promise that was
pending then has been kept. A cycle that ends with no more duties than an earlier one began with
closes a loop: what led from there to here can be repeated for ever. When a promise cannot be kept,
the state is dead, and the search goes back. Both are complete: there are finitely many states.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from vaso.satisfiability.clock import Clock
from vaso.satisfiability.frames import Promise
from vaso.satisfiability.steps import State, Step, Steps
from vaso.satisfiability.tableau import Tableau

__all__ = ["Lasso", "find_behaviour"]

_COMPARED = 200  # cycles that a new state is compared with, beyond those with the same duties


@dataclass(frozen=True, slots=True)
class Lasso:
    """A behaviour that ends in a loop.

    Attributes:
        steps: Truth values of the propositions, step by step.
        loop_start: What follows the last step is ``steps[loop_start]``.
    """

    steps: tuple[Mapping[str, bool], ...]
    loop_start: int


def find_behaviour(tableau: Tableau, clock: Clock) -> Lasso | None:
    """Find a behaviour that fulfils the formulas of a tableau.

    Returns:
        A lasso, or None if there is no such behaviour.

    Raises:
        OutOfTimeError: The clock said so first.
    """
    steps = Steps(tableau, clock)
    try:
        return _Search(tableau, steps).run()
    finally:
        steps.close()


@dataclass(slots=True)
class _Stage:
    """A state on the way, and the steps from it to the next stage.

    Attributes:
        state: Its duties.
        pending: Promises of this cycle that are still to be kept.
        is_start: Whether a cycle starts here.
        path: The steps to the next stage.
    """

    state: State
    pending: State
    is_start: bool
    path: list[Step] = field(default_factory=list)


class _Search:
    """The stages found so far, of which the last one is to be continued."""

    def __init__(self, tableau: Tableau, steps: Steps) -> None:
        self._tableau = tableau
        self._steps = steps
        self._events = frozenset(steps.events)
        self._promises: dict[int, Promise] = {}
        self._stages: list[_Stage] = []
        self._starts: dict[State, int] = {}

    def run(self) -> Lasso | None:
        self._begin_cycle(frozenset(self._tableau.start))
        while self._stages:
            stage = self._stages[-1]
            path = self._onward(stage)
            if path is None:
                self._go_back()
                continue
            stage.path = path
            state, pending = path[-1].after, self._still_pending(stage.pending, path)
            if pending:
                self._stages.append(_Stage(state, pending, is_start=False))
                continue
            first = self._earlier(state)
            if first is not None:
                return self._lasso(first)
            self._begin_cycle(state)
        return None

    def _begin_cycle(self, state: State) -> None:
        self._starts[state] = len(self._stages)
        self._stages.append(_Stage(state, state & self._events, is_start=True))

    def _onward(self, stage: _Stage) -> list[Step] | None:
        """Keep all pending promises in one step if possible, else the first of them."""
        wish = [self._steps.events[event] for event in stage.pending]
        if self._steps.can(stage.state, wish):
            return [self._steps.found(stage.state)]
        if not stage.pending:
            duties, _ = self._steps.blame(stage.state, wish)
            self._steps.forbid(duties)
            return None
        event = min(stage.pending)
        if event not in self._promises:
            self._promises[event] = Promise(self._steps, event)
        return self._promises[event].reach(stage.state)

    def _still_pending(self, pending: State, path: list[Step]) -> State:
        for step in path:
            pending -= step.kept
        return pending

    def _go_back(self) -> None:
        while self._stages and self._steps.is_dead(self._stages[-1].state):
            gone = self._stages.pop()
            if gone.is_start:
                del self._starts[gone.state]

    def _earlier(self, state: State) -> int | None:
        """The start of a cycle with at least these duties."""
        same = self._starts.get(state)
        if same is not None:
            return same
        for index in range(len(self._stages) - 1, max(-1, len(self._stages) - _COMPARED), -1):
            if self._stages[index].is_start and state <= self._stages[index].state:
                return index
        return None

    def _lasso(self, first: int) -> Lasso:
        names = list(self._tableau.letters)
        steps = tuple(
            dict(zip(names, step.letters, strict=True))
            for stage in self._stages
            for step in stage.path
        )
        return Lasso(steps, sum(len(stage.path) for stage in self._stages[:first]))
