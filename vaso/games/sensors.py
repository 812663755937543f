"""The sensors' winning strategy, state by state."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from omega.symbolic import fixpoint

from vaso.games.encoding import Encoded
from vaso.games.robot import MAX_NODES

__all__ = ["Sensors"]

Node = tuple[int, int, tuple[int, ...]]
"""Input, output, and the state of every monitor before them."""
Memory = tuple[int, int, int]
"""Level of the solution, the rule that is to fail, the assumption that is to come about next."""


class Sensors:
    """The sensors' strategy: what they show in answer to each output.

    Read off the iterates of the solution: go to a lower level where that can be forced; else stay
    where one rule is never met, and go round the assumptions. On a lower level all starts anew.
    """

    def __init__(self, encoded: Encoded) -> None:
        self.encoded, self.aut = encoded, encoded.aut
        self.levels, self.regions, self.attractors = encoded.solution
        self.goals = self.aut.win["[]<>"]
        self.letters = [{tuple(x): i for i, x in enumerate(m["letters"])} for m in encoded.monitors]
        self._forcible: dict[Any, Any] = {}

    def machine(self) -> dict[str, Any] | None:
        """All states that can be reached."""
        game, start = self.encoded.game, (0,) * len(self.encoded.monitors)
        queue: list[tuple[Node, Memory]] = []
        index: dict[tuple[Node, Memory], int] = {}

        def number(node: Node, memory: Memory) -> int:
            found = (node, self._renewed(node, memory))
            if found not in index:
                index[found] = len(queue)
                queue.append(found)
            return index[found]

        fresh = (len(self.levels), 0, 0)
        begin = {a: number(self._shown(self.encoded.region, a, start), fresh) for a in game["rest"]}
        after = []
        for node, memory in queue:
            target, kept = self._target(node, memory)
            later = self._later(node)
            after.append({a: number(self._shown(target, a, later), kept) for a in game["usable"]})
            if len(queue) > MAX_NODES:
                return None
        return {"inputs": [node[0] for node, _ in queue], "start": begin, "after": after}

    def _renewed(self, node: Node, memory: Memory) -> Memory:
        """The memory, or a new one on a lower level."""
        level = next(k for k, z in enumerate(self.levels) if self._within(z, node))
        if level == memory[0]:
            return memory
        rule = next((i for i, y in enumerate(self.regions[level]) if self._within(y, node)))
        return level, rule, 0

    def _target(self, node: Node, memory: Memory) -> tuple[Any, Memory]:
        """Where to go next, and with which memory."""
        level, rule, goal = memory
        below = self.levels[level - 1] if level else self.aut.false
        if self._within(self._forced(below), node):
            return below, memory
        if self._within(self.goals[goal], node):
            return self.regions[level][rule], (level, rule, (goal + 1) % len(self.goals))
        ranks = self.attractors[level][rule][goal]
        return next(x for x in ranks if self._within(self._forced(x), node)), memory

    def _forced(self, target: Any) -> Any:
        """From where the sensors can go to a set, whatever the robot does."""
        if target not in self._forcible:
            actions = self.aut.action
            self._forcible[target] = fixpoint.step(actions["env"], actions["sys"], target, self.aut)
        return self._forcible[target]

    def _within(self, region: Any, node: Node) -> bool:
        return bool(self.aut.bdd.let(self._values(*node), region) == self.aut.true)

    def _values(self, given: int, done: int, states: Sequence[int]) -> dict[str, bool]:
        encoded = self.encoded
        coded = [(encoded.given, given), (encoded.done, done)]
        coded += list(zip(encoded.states, states, strict=True))
        return {b: bool(n >> i & 1) for bits, n in coded for i, b in enumerate(bits)}

    def _shown(self, target: Any, done: int, states: tuple[int, ...]) -> Node:
        """The first input that is in a set under an output."""
        nodes = ((e, done, states) for e in range(self.encoded.game["inputs"]))
        return next(node for node in nodes if self._within(target, node))

    def _later(self, node: Node) -> tuple[int, ...]:
        given, done, states = node
        truth = [_value(table, given, done) for table in self.encoded.game["atoms"]]
        return tuple(
            m["after"][s][letters[tuple(truth[i] for i in m["atoms"])]]
            for m, letters, s in zip(self.encoded.monitors, self.letters, states, strict=True)
        )


def _value(table: dict[str, Any], given: int, done: int) -> bool:
    if table["input"] is not None:
        return bool(table["input"][given])
    return bool(table["output"][done] if table["both"] is None else table["both"][given][done])
