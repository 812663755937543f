"""A game as binary decision diagrams, solved with omega."""

from __future__ import annotations

import contextlib
import functools
import io
import operator
from collections.abc import Iterable, Sequence
from typing import Any

from omega.games import gr1
from omega.symbolic import prime, temporal

__all__ = ["Encoded"]


class Encoded:
    """A game as diagrams, for the robot's side or, ``dual``, for the side of the sensors.

    The robot chooses its output and the sensors answer, so the robot plays Moore, and the sensors
    Mealy. Codes beyond the number of inputs or outputs stand for the first input or no output.
    """

    def __init__(self, game: dict[str, Any], *, dual: bool = False) -> None:
        self.game, self.dual = game, dual
        self.monitors = game["assumptions"] + game["rules"]
        streett, rabin = temporal.default_streett_automaton, temporal.default_rabin_automaton
        self.aut = rabin() if dual else streett()
        self.given = _bits("e", game["inputs"])
        self.done = _bits("a", game["outputs"])
        self.states = [_bits(f"q{i}", len(m["after"])) for i, m in enumerate(self.monitors)]
        ours = [*self.done, *(b for bits in self.states for b in bits)]
        for bit in (*self.given, *ours):  # one by one: the order of the diagrams' variables
            self.aut.declare_variables(**{bit: "bool"})
        sides = ("sys", "env") if dual else ("env", "sys")
        self.aut.varlist = {sides[0]: list(self.given), sides[1]: ours}
        self.aut.action[sides[0]] = self.aut.true
        self.aut.action[sides[1]] = self._moves()
        self.start = self._any(self.code(self.done, a) for a in game["rest"])
        for bits in self.states:
            self.start &= self.code(bits, 0)
        self.aut.init[sides[0]], self.aut.init[sides[1]] = self.aut.true, self.start
        self.aut.moore, self.aut.qinit = not dual, r"\A \E" if dual else r"\E \A"
        self._winning()

    # --- diagrams ------------------------------------------------------------------------------

    def _any(self, parts: Iterable[Any]) -> Any:
        return functools.reduce(operator.or_, parts, self.aut.false)

    def _all(self, parts: Iterable[Any]) -> Any:
        return functools.reduce(operator.and_, parts, self.aut.true)

    def code(self, bits: Sequence[str], number: int, mark: str = "") -> Any:
        """That some bits, with a mark after their names, are the code of a number."""
        cube = {f"{b}{mark}": bool(number >> i & 1) for i, b in enumerate(bits)}
        return self.aut.bdd.cube(cube) if cube else self.aut.true

    @functools.cached_property
    def _inputs(self) -> list[Any]:
        """The codes of each input; those left over count as the first input."""
        exact = [self.code(self.given, e) for e in range(self.game["inputs"])]
        return [exact[0] | ~self._any(exact), *exact[1:]]

    @functools.cached_property
    def _outputs(self) -> list[Any]:
        return [self.code(self.done, a) for a in range(self.game["outputs"])]

    @functools.cached_property
    def _atoms(self) -> list[Any]:
        return [self._atom(table) for table in self.game["atoms"]]

    def _atom(self, table: dict[str, Any]) -> Any:
        if table["input"] is not None:
            return self._where(self._inputs, table["input"])
        if table["output"] is not None:
            return self._where(self._outputs, table["output"])
        rows = (self._where(self._outputs, row) for row in table["both"])
        return self._any(e & row for e, row in zip(self._inputs, rows, strict=True))

    def _where(self, codes: Sequence[Any], values: Sequence[bool]) -> Any:
        return self._any(c for c, value in zip(codes, values, strict=True) if value)

    def _moves(self) -> Any:
        """The next output is usable, and every monitor takes the step that it must."""
        usable = self._any(self.code(self.done, a, "'") for a in self.game["usable"])
        steps = [self._steps(m, bits) for m, bits in zip(self.monitors, self.states, strict=True)]
        return self._all([usable, *steps])

    def _steps(self, monitor: dict[str, Any], bits: Sequence[str]) -> Any:
        names = [self._atoms[i] for i in monitor["atoms"]]
        letters = [
            self._all(n if v else ~n for n, v in zip(names, letter, strict=True))
            for letter in monitor["letters"]
        ]
        at = [self.code(bits, s) for s in range(len(monitor["after"]))]
        found = self.aut.true
        for i, bit in enumerate(bits):
            on = self._any(
                at[s] & letters[c]
                for s, row in enumerate(monitor["after"])
                for c, target in enumerate(row)
                if target >> i & 1
            )
            found &= self.aut.bdd.apply("<=>", self.aut.bdd.var(f"{bit}'"), on)
        return found

    def _winning(self) -> None:
        accepting = [
            self._any(self.code(bits, s) for s, good in enumerate(m["accepting"]) if good)
            for m, bits in zip(self.monitors, self.states, strict=True)
        ]
        count = len(self.game["assumptions"])
        assumed, rules = accepting[:count], accepting[count:]
        safety = [m["safety"] for m in self.game["rules"]]
        kept = self._all(a for a, safe in zip(rules, safety, strict=True) if safe)
        goals = [kept, *(a for a, safe in zip(rules, safety, strict=True) if not safe)]
        if self.dual:
            self.aut.win["<>[]"] = [~g for g in goals]
            self.aut.win["[]<>"] = _at_least(2, assumed or [self.aut.true])
        else:
            self.aut.win["<>[]"] = [~a for a in assumed] or [self.aut.false]
            self.aut.win["[]<>"] = _at_least(2, goals)

    # --- answers -------------------------------------------------------------------------------

    def solve(self) -> bool:
        """Whether the player wins from the start."""
        if self.dual:
            self.solution = gr1.solve_rabin_game(self.aut)
            self.region = self.solution[0][-1]
        else:
            self.solution = gr1.solve_streett_game(self.aut)
            self.region = self.solution[0]
        with contextlib.redirect_stdout(io.StringIO()):
            return bool(gr1.is_realizable(self.region, self.aut))

    def first_choices(self) -> list[list[int]]:
        """For each input in state 0, the outputs of state 1 after which the robot still wins."""
        sys_moves = self.aut.action["sys"] & prime.prime(self.region, self.aut)
        good = self.aut.forall(self.aut.varlist["env'"], sys_moves)
        good = self.aut.exist([f"{b}'" for bits in self.states for b in bits], good & self.start)
        return [
            [a for a in self.game["usable"] if self._meets(good, e, a)]
            for e in range(self.game["inputs"])
        ]

    def _meets(self, relation: Any, given: int, done: int) -> bool:
        choice = self.code(self.given, given) & self.code(self.done, done, "'")
        return bool((relation & choice) != self.aut.false)


def _bits(name: str, count: int) -> list[str]:
    return [f"{name}_{i}" for i in range(max(1, (count - 1).bit_length()))]


def _at_least(count: int, goals: list[Any]) -> list[Any]:
    """The goals, one repeated where they are fewer: a counter of goals needs a range."""
    return goals + goals[:1] * (count - len(goals))
