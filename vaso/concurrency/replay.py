"""Replaying a run of the product on the members: who does what, in which line, step by step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vaso.concurrency.product import Move, Place, Product
from vaso.plan.transition_system import Edge, Guard, Scalar, State, TransitionSystem, covers
from vaso.verifiers.base import Lasso

__all__ = ["Replay", "replay"]

LONGEST = 200_000


@dataclass(frozen=True)
class Replay:
    """A run of a product, with the part of the product that it touches.

    Attributes:
        system: The states and steps of the run.
        lasso: The run in that system.
        places: The place of the product in each of its steps.
        moves: What each member does after each of its steps.
    """

    system: TransitionSystem
    lasso: Lasso
    places: tuple[Place, ...]
    moves: tuple[Move, ...]


def replay(product: Product, lasso: Lasso) -> Replay | None:
    """Follow the sensor values and turns of a run on a product.

    Args:
        product: The product; it may have more states and sensors than the system of the run.
        lasso: A run. Only its sensor values count; missing ones get their first value, or False.

    Returns:
        The run, closed where place and position in the loop repeat; None if that takes too long.
    """
    usual = {s.name: False if False in s.domain else s.domain[0] for s in product.sensors}
    values = [{**usual, **_known(v, usual)} for _, v in lasso.run]
    run: list[tuple[Place, Guard, Move]] = []
    seen: dict[tuple[Place, int], int] = {}
    place, index = product.start, 0
    while len(run) < LONGEST:
        if (place, index) in seen:
            return _replay(product, run, seen[place, index])
        seen[place, index] = len(run)
        move = next(m for m in product.moves(place) if covers(m.guard, values[index]))
        run.append((place, values[index], move))
        place = move.target
        index = index + 1 if index + 1 < len(values) else lasso.loop_start
    return None


def _known(values: Guard, usual: Guard) -> dict[str, Scalar]:
    return {name: value for name, value in values.items() if name in usual}


def _replay(product: Product, run: Sequence[tuple[Place, Guard, Move]], start: int) -> Replay:
    numbers: dict[Place, int] = {}
    for place, _, _ in run:
        numbers.setdefault(place, len(numbers))
    edges: list[dict[tuple[tuple[str, Scalar], ...], Edge]] = [{} for _ in numbers]
    for place, values, move in run:
        key = tuple(values.items())
        edges[numbers[place]][key] = Edge(values, numbers[move.target])
    states: list[State] = [product.state(place) for place in numbers]
    system = TransitionSystem(
        states=tuple(states),
        edges=tuple(tuple(out.values()) for out in edges),
        sensors=product.sensors,
        dt=product.dt,
    )
    lasso = Lasso(tuple((numbers[place], values) for place, values, _ in run), start)
    return Replay(system, lasso, tuple(p for p, _, _ in run), tuple(m for _, _, m in run))
