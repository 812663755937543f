"""Strategies of both players as finite machines, and whether they win."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from vaso.synthesis.game import Game, Situation

__all__ = ["Robot", "Sensors", "cycles", "reached", "robot_wins", "sensors_win", "simplified"]

N = TypeVar("N", bound=Hashable)


@dataclass(frozen=True)
class Robot:
    """A strategy of the robot. State 0 is the one at rest.

    Attributes:
        outputs: What is executed in each state.
        after: ``after[state][input]`` is the next state.
    """

    outputs: tuple[int, ...]
    after: tuple[tuple[int, ...], ...]

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Robot:
        """Read the answer of the solver."""
        return cls(tuple(data["outputs"]), tuple(tuple(row) for row in data["after"]))

    def minimised(self) -> Robot:
        """The same behaviour with the fewest states.

        What is executed in the state at rest is not chosen, and does not tell it from others.
        """
        block = [0] * len(self.outputs)
        while True:
            signatures = [
                (b, *((self.outputs[t], block[t]) for t in row))
                for b, row in zip(block, self.after, strict=True)
            ]
            numbers = {s: i for i, s in enumerate(dict.fromkeys(signatures))}
            refined = [numbers[s] for s in signatures]
            if len(numbers) == len(set(block)):
                break
            block = refined
        return self._quotient(block)

    def _quotient(self, block: Sequence[int]) -> Robot:
        """One state for each block and output that can be reached."""
        start = (block[0], self.outputs[0])
        first = {b: block.index(b) for b in block}
        index, queue, after = {start: 0}, [start], []
        for found, _ in queue:
            row = []
            for target in self.after[first[found]]:
                node = (block[target], self.outputs[target])
                if node not in index:
                    index[node] = len(queue)
                    queue.append(node)
                row.append(index[node])
            after.append(tuple(row))
        return Robot(tuple(a for _, a in queue), tuple(after))


def simplified(robot: Robot, game: Game, deadline: float) -> Robot:
    """A winning strategy with fewer things to remember, by merging situations while it still wins.

    Args:
        robot: A winning strategy.
        game: The game.
        deadline: When to leave it at that, on the clock ``time.monotonic``.
    """
    robot = robot.minimised()
    rows = list(dict.fromkeys(robot.after))
    for kept, gone in itertools.combinations(rows, 2):
        if time.monotonic() > deadline:
            return robot
        if {kept, gone} <= {*robot.after}:
            after = tuple(kept if row == gone else row for row in robot.after)
            merged = Robot(robot.outputs, after).minimised()
            if robot_wins(merged, game):
                return simplified(merged, game, deadline)
    return robot


@dataclass(frozen=True)
class Sensors:
    """A strategy of the sensors.

    Attributes:
        inputs: What the sensors show in each state.
        start: For each output that state 0 can have, the state that it begins in.
        after: For each state and each next output, the next state.
    """

    inputs: tuple[int, ...]
    start: Mapping[int, int]
    after: tuple[Mapping[int, int], ...]

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Sensors:
        """Read the answer of the solver."""

        def row(raw: Mapping[str, int]) -> dict[int, int]:
            return {int(a): s for a, s in raw.items()}

        return cls(tuple(data["inputs"]), row(data["start"]), tuple(map(row, data["after"])))


def robot_wins(robot: Robot, game: Game) -> bool:
    """Tell whether a strategy of the robot wins against every behaviour of the sensors."""
    inputs = range(len(game.arena.inputs))

    def following(node: tuple[int, Situation]) -> Iterator[tuple[int, Situation]]:
        state, situation = node
        for e in inputs:
            yield robot.after[state][e], game.after(situation, e, robot.outputs[state])

    graph = reached([(0, game.start)], following)
    return not _refuting(graph, game)


def sensors_win(sensors: Sensors, game: Game) -> bool:
    """Tell whether a strategy of the sensors wins against everything that the robot can do."""

    def following(node: tuple[int, int, Situation]) -> Iterator[tuple[int, int, Situation]]:
        state, done, situation = node
        later = game.after(situation, sensors.inputs[state], done)
        for a in game.arena.usable:
            yield sensors.after[state][a], a, later

    start = [(sensors.start[a], a, game.start) for a in game.arena.rest]
    graph = reached(start, following)
    assumed, kept = _acceptance(game, _situation_of_three)
    if any(True for _ in cycles(graph, kept)):
        return False
    return not any(True for good in assumed for _ in cycles(_without(graph, good), []))


def _refuting(graph: Mapping[tuple[int, Situation], Collection[Any]], game: Game) -> bool:
    """Whether the sensors have a cycle that keeps the assumptions and breaks a rule."""
    assumed, rules = _acceptance(game, _situation_of_two)
    return any(True for good in rules for _ in cycles(_without(graph, good), assumed))


def _situation_of_two(node: tuple[int, Situation]) -> Situation:
    return node[1]


def _situation_of_three(node: tuple[int, int, Situation]) -> Situation:
    return node[2]


def _acceptance(
    game: Game, situation: Callable[[N], Situation]
) -> tuple[list[Callable[[N], bool]], list[Callable[[N], bool]]]:
    """For each assumption and for each rule: whether a node is accepting."""

    def accepts(i: int) -> Callable[[N], bool]:
        return lambda node: game.accepted(situation(node))[i]

    count = len(game.assumptions)
    found = [accepts(i) for i in range(count + len(game.rules))]
    return found[:count], found[count:]


def _without(graph: Mapping[N, Collection[N]], gone: Callable[[N], bool]) -> dict[N, Collection[N]]:
    kept = {n for n in graph if not gone(n)}
    return {n: [t for t in graph[n] if t in kept] for n in graph if n in kept}


def reached(start: Iterable[N], following: Callable[[N], Iterable[N]]) -> dict[N, set[N]]:
    """The graph of the nodes that can be reached, each with those that follow it."""
    graph: dict[N, set[N]] = {}
    todo = list(start)
    while todo:
        node = todo.pop()
        if node not in graph:
            graph[node] = set(following(node))
            todo += graph[node]
    return graph


def cycles(
    graph: Mapping[N, Collection[N]], wanted: Sequence[Callable[[N], bool]]
) -> Iterator[list[N]]:
    """Yield the strongly connected parts with a cycle, and a node of each wanted kind.

    Tarjan's algorithm (Depth-First Search and Linear Graph Algorithms, 1972), without recursion.
    """
    for part in _components(graph):
        inside = len(part) > 1 or part[0] in graph[part[0]]
        if inside and all(any(w(n) for n in part) for w in wanted):
            yield part


def _components(graph: Mapping[N, Collection[N]]) -> Iterator[list[N]]:
    number: dict[N, int] = {}
    low: dict[N, int] = {}
    open_: dict[N, None] = {}
    for root in graph:
        if root in number:
            continue
        number[root] = low[root] = len(number)
        open_[root] = None
        path = [(root, iter(graph[root]))]
        while path:
            node, rest = path[-1]
            target = next((t for t in rest if t not in number or t in open_), None)
            if target is None:
                path.pop()
                if path:
                    low[path[-1][0]] = min(low[path[-1][0]], low[node])
                if low[node] == number[node]:
                    yield _close(open_, node)
            elif target in number:
                low[node] = min(low[node], number[target])
            else:
                number[target] = low[target] = len(number)
                open_[target] = None
                path.append((target, iter(graph[target])))


def _close(open_: dict[N, None], node: N) -> list[N]:
    part = []
    while True:
        last, _ = open_.popitem()
        part.append(last)
        if last == node:
            return part
