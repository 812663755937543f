"""The robot's winning strategy, state by state."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Sequence
from typing import Any

from omega.games import gr1

from vaso.games.encoding import Encoded

__all__ = ["MAX_NODES", "Robot"]

MAX_NODES = 20_000


class Robot:
    """The robot's strategy: a state says what is executed, and what follows each input."""

    def __init__(self, encoded: Encoded) -> None:
        self.encoded, self.aut = encoded, encoded.aut
        with contextlib.redirect_stdout(io.StringIO()):
            gr1.make_streett_transducer(*encoded.solution, self.aut)
        memory = [v for v in self.aut.varlist["impl"] if v.startswith("_")]
        bits = [b for v in memory for b in self.aut.vars[v]["bitnames"]]
        self.names = [*encoded.done, *(b for s in encoded.states for b in s), *bits]
        self.order = {a: i for i, a in enumerate(encoded.game.get("order", []))}

    def machine(self) -> dict[str, Any] | None:
        """All states that can be reached."""
        game, encoded = self.encoded.game, self.encoded
        init = self.aut.forall(encoded.given, self.aut.init["impl"] & encoded.start)
        queue = [self._best(init, self.names)]
        index, after = {queue[0]: 0}, []
        primed = [f"{n}'" for n in self.names]
        for node in queue:
            here = self.aut.action["impl"] & self._cube(node)
            row = []
            for e in range(game["inputs"]):
                target = self._best(here & encoded.code(encoded.given, e), primed)
                if target not in index:
                    index[target] = len(queue)
                    queue.append(target)
                row.append(index[target])
            after.append(row)
            if len(queue) > MAX_NODES:
                return None
        return {"outputs": [self._output(node) for node in queue], "after": after}

    def _cube(self, node: tuple[bool, ...]) -> Any:
        return self.aut.bdd.cube(dict(zip(self.names, node, strict=True)))

    def _output(self, node: tuple[bool, ...]) -> int:
        return _number(node[: len(self.encoded.done)])

    def _best(self, relation: Any, names: Sequence[str]) -> tuple[bool, ...]:
        """The values of some variables in a relation that are preferred."""
        others = self.aut.bdd.support(relation) - {*names}
        found = self.aut.bdd.pick_iter(self.aut.bdd.exist(others, relation), care_vars={*names})
        nodes = (tuple(one[n] for n in names) for one in found)
        return min(nodes, key=lambda node: (self.order.get(self._output(node), 0), node))


def _number(code: Sequence[bool]) -> int:
    return sum(1 << i for i, bit in enumerate(code) if bit)
