"""The reachable part of a product as one transition system, within bounds."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace

from vaso.concurrency.product import Move, Place, Product
from vaso.plan.explore import Budget
from vaso.plan.transition_system import Cut, Edge, TransitionSystem

__all__ = ["build", "cut_of"]


def build(product: Product, budget: Budget) -> TransitionSystem:
    """The part of a product that can be reached, as one transition system.

    Args:
        product: The product.
        budget: Bounds; places beyond them are cuts, of which nothing is said.
    """
    return _Builder(product, budget).run()


class _Builder:
    """Breadth-first search over places; they are numbered in the order in which they are found."""

    def __init__(self, product: Product, budget: Budget) -> None:
        self.product = product
        self.budget = budget
        self.places: list[Place] = []
        self.numbers: dict[Place, int] = {}
        self.depths: list[int] = []
        self.edges: list[tuple[Edge, ...]] = []
        self.deadline = time.monotonic() + budget.seconds
        self.bound = ""

    def run(self) -> TransitionSystem:
        self._number(self.product.start, 0)
        while len(self.edges) < len(self.places) and not self._spent():
            self.edges.append(tuple(self._edges(len(self.edges))))
        known = len(self.edges)
        self.edges += [(Edge({}, number),) for number in range(known, len(self.places))]
        return self._system(known)

    def _number(self, place: Place, depth: int) -> int:
        if place not in self.numbers:
            self.numbers[place] = len(self.places)
            self.places.append(place)
            self.depths.append(depth)
        return self.numbers[place]

    def _spent(self) -> bool:
        if len(self.numbers) > self.budget.states:
            self.bound = f"the bound of {self.budget.states} joint states was reached"
        elif time.monotonic() > self.deadline:
            self.bound = f"the bound of {self.budget.seconds:g} seconds was reached"
        return bool(self.bound)

    def _edges(self, number: int) -> Iterator[Edge]:
        depth = self.depths[number] + 1
        for move in self.product.moves(self.places[number]):
            yield Edge(move.guard, self._number(move.target, depth), reads=self._reads(move))

    def _reads(self, move: Move) -> tuple[tuple[str, int | None], ...]:
        pairs = zip(self.product.names, move.taken, strict=True)
        return tuple((f"{n}.{read}", line) for n, e in pairs if e for read, line in e.reads)

    def _system(self, known: int) -> TransitionSystem:
        states = [self.product.state(place) for place in self.places]
        states[known:] = [replace(state, cut=True) for state in states[known:]]
        reached = [
            (place, depth)
            for place, depth, state in zip(self.places, self.depths, states, strict=True)
            if state.cut
        ]
        return TransitionSystem(
            states=tuple(states),
            edges=tuple(self.edges),
            sensors=self.product.sensors,
            dt=self.product.dt,
            cut=cut_of(self.product, reached, self.bound),
        )


def cut_of(product: Product, reached: Sequence[tuple[Place, int]], bound: str) -> Cut | None:
    """Why a search of a product is not complete.

    Args:
        product: The product.
        reached: The places of which nothing is known, each with the number of steps to it.
        bound: The bound that was reached, or an empty string.
    """
    if not reached:
        return None
    depth = max(0, min(d for _, d in reached) - 1)
    found = {i for place, _ in reached for i, state in enumerate(product.here(place)) if state.cut}
    cuts = {i: product.systems[i].cut or Cut("exploration stopped", None, 0) for i in sorted(found)}
    told = [f"{product.names[i]}: {cut.reason}" for i, cut in cuts.items()]
    lines = {cut.line for cut in cuts.values()}
    return Cut(
        "; ".join([*told, *([bound] if bound else [])]),
        lines.pop() if len(lines) == 1 else None,
        depth,
        all(cut.supported for cut in cuts.values()),
    )
