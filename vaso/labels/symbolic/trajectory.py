"""Proof for robots that fly a list of set-points, by induction over its length.

A label is a function of the set-points so far. What a loop over all but the last of them leaves in
its variables is not known; so guesses are made, such as "the variable z is the robot's altitude",
and those are kept that hold on the robot at rest and that one more set-point preserves (Houdini:
Flanagan & Leino, Houdini, an annotation assistant for ESC/Java, FME 2001). From what is kept it
must follow that the label is the truth after the next set-point, whatever it is.
"""

from __future__ import annotations

import ast
import random
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import z3

from vaso.labels.functions import Functions
from vaso.labels.symbolic import Proofs
from vaso.labels.symbolic.guesses import (
    Guess,
    Quantities,
    all_guesses,
    meaning,
    of_point,
    of_robot,
    surely,
)
from vaso.labels.symbolic.history import History
from vaso.labels.symbolic.interpreter import Interpreter
from vaso.labels.symbolic.loops import Loop, Loops
from vaso.labels.symbolic.models import assignment
from vaso.labels.symbolic.names import issued_record
from vaso.labels.symbolic.paths import Path, explore, holds, model_of
from vaso.labels.symbolic.program import Program
from vaso.labels.symbolic.values import (
    NotUnderstoodError,
    PythonError,
    Value,
    equal,
    is_term,
)
from vaso.labels.symbolic.world import World
from vaso.labels.trial import Send, Trial
from vaso.platforms import Command, Platform

__all__ = ["prove_trajectory"]

DETAIL = "for every list of set-points, by induction, in real arithmetic"
MAX_ROUNDS = 20
SIMULATED = 20
"""Set-points of the flight that tests guesses before the solver does."""
LONGEST = 2
"""Set-points in a list for which a label that is not proved is suspected to be wrong."""


def prove_trajectory(
    tree: ast.Module, platform: Platform, functions: Functions, deadline: float
) -> Proofs:
    """Prove labels equal to the truth, or find set-points for which they may not be.

    Only trajectories are covered: code with functions that send commands is not proved.
    """
    track = platform.command(platform.trajectory or "")
    sends = any(isinstance(n, ast.Global | ast.Nonlocal) for n in ast.walk(tree))
    names = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)}
    if track is None or sends or names & {c.name for c in platform.commands}:
        return Proofs()
    world, found = World(platform), Proofs()
    for name, kinds in functions.labels.items():
        proof = _Induction(tree, platform, track, world, name, kinds, deadline)
        with suppress(NotUnderstoodError):
            if proof.proved():
                found.proved[name] = DETAIL
                continue
        with suppress(NotUnderstoodError):
            found.suspects += proof.suspects()
    return found


@dataclass
class _Induction:
    """The proof for one proposition.

    Attributes:
        tree: The labelling code.
        platform: The platform.
        track: The command that a set-point stands for.
        world: The dynamics.
        name: The proposition.
        kinds: The parameters of its function.
        deadline: When to give up.
    """

    tree: ast.Module
    platform: Platform
    track: Command
    world: World
    name: str
    kinds: tuple[tuple[str, str], ...]
    deadline: float
    guesses: list[Guess] = field(default_factory=list)
    loops: dict[tuple[int, int], Loop] = field(default_factory=dict)

    def proved(self) -> bool:
        """True only if the label is the truth for every list of set-points."""
        found = [quantities for _, quantities in explore(self._at_rest, self.deadline)]
        if len(found) != 1 or found[0] is None:
            return False
        self.guesses = [g for g in all_guesses(found[0]) if surely(meaning(g, found[0]))]
        self._simulate(found[0])
        return self._settle_guesses() and self._label_is_truth()

    # -- the robot at rest -------------------------------------------------------------------------

    def _at_rest(self, path: Path) -> Quantities | None:
        """All quantities after the set-point at rest; None where the label is not the truth."""
        rest = self.platform.rest.arguments[0][1]
        loops = Loops()
        label = self._label(path, History(first=rest, known=[rest]), rest, rest, loops)
        truth = self.world.truth(path, self.world.initial).get(self.name)
        if truth is None or not holds(path, equal(label, truth)):
            return None
        self.loops = loops.found
        return {**loops.after, **of_robot(self.world.initial), **of_point(rest)}

    # -- guesses -----------------------------------------------------------------------------------

    def _simulate(self, after: Quantities) -> None:
        """Drop the guesses that a flight along random set-points shows to be wrong."""
        rng, path = random.Random(0), Path([], [], self.deadline)
        world = self.world.initial
        inside = {key: loop.at_rest(after) for key, loop in self.loops.items()}
        for _ in range(SIMULATED):
            size = self.track.parameters[0].size or 0
            point = tuple(rng.randint(-16, 16) / 8 for _ in range(size))
            world = self._moved(path, world, point)
            here = {**of_robot(world), **of_point(point)}
            for key, known in inside.items():
                self._turn(path, self.loops[key], point, known)
                here |= self.loops[key].quantities(known)
            self.guesses = [g for g in self.guesses if surely(meaning(g, here))]

    def _settle_guesses(self) -> bool:
        """Keep the guesses that one more set-point preserves; False if time is up before."""
        for _ in range(MAX_ROUNDS):
            dropped: set[Guess] = set()
            for path, after in explore(self._one_turn, self.deadline):
                dropped |= self._broken(path, after)
            if not dropped:
                return True
            self.guesses = [g for g in self.guesses if g not in dropped]
        return False

    def _one_turn(self, path: Path) -> Quantities:
        """The quantities after one more set-point, on any robot for which the guesses hold."""
        last, point = self._points(path)
        world = self.world.unknown(path)
        before = {**of_robot(world), **of_point(last)}
        inside = {key: loop.anywhere(path) for key, loop in self.loops.items()}
        for key, known in inside.items():
            before |= self.loops[key].quantities(known)
        self._assume(path, before)
        after = {**of_robot(self._moved(path, world, point)), **of_point(point)}
        for key, known in inside.items():
            loop = self.loops[key]
            self._turn(path, loop, point, known)
            after |= loop.quantities(known)
        return after

    def _turn(self, path: Path, loop: Loop, point: Value, known: Quantities) -> None:
        try:
            Interpreter(path).run_turn(loop.node, point, known, loop.names)
        except PythonError as error:
            raise NotUnderstoodError(f"a loop may raise {error}") from error

    def _broken(self, path: Path, after: Quantities) -> set[Guess]:
        """Guesses that may not hold after one more set-point on a path."""
        kept = {guess: meaning(guess, after) for guess in self.guesses}
        dropped = {guess for guess, fact in kept.items() if not is_term(fact) and not fact}
        kept = {guess: fact for guess, fact in kept.items() if is_term(fact)}
        while kept:
            wrong = z3.Or([z3.Not(fact) for fact in kept.values()])
            answer, model = model_of(path.given(wrong))
            if answer == z3.unsat:
                return dropped
            if model is None:  # not known for all at once: one by one
                return dropped | {g for g, fact in kept.items() if not holds(path, fact)}
            false = {g for g, f in kept.items() if z3.is_false(model.eval(f, True))}
            if not false:
                return dropped | kept.keys()
            dropped |= false
            kept = {guess: fact for guess, fact in kept.items() if guess not in false}
        return dropped

    def _assume(self, path: Path, known: Quantities) -> None:
        """Assume the guesses about some quantities."""
        for guess in self.guesses:
            if guess[1] in known and guess[2] in known:
                fact = meaning(guess, known)
                if is_term(fact):
                    path.conditions.append(fact)

    # -- the label ---------------------------------------------------------------------------------

    def _label_is_truth(self) -> bool:
        for path, (label, truth) in explore(self._one_more, self.deadline):
            alike = isinstance(label, bool | z3.BoolRef) == isinstance(truth, bool | z3.BoolRef)
            if truth is None or not alike or not holds(path, equal(label, truth)):
                return False
        return True

    def _one_more(self, path: Path) -> tuple[Value, Value]:
        """Label and truth after any set-points and one more."""
        last, point = self._points(path)
        count = path.fresh("count", "int")
        path.conditions.append(count >= 1)
        world = self.world.unknown(path)
        last = self._remembered(of_robot(world), last)
        known = {**of_robot(world), **of_point(last)}
        self._assume(path, known)
        loops = Loops(self.loops, lambda more: self._assume(path, {**known, **more}))
        rest = self.platform.rest.arguments[0][1]
        history = History([point], last, rest, None, count)
        label = self._label(path, history, point, last, loops)
        return label, self.world.truth(path, self._moved(path, world, point)).get(self.name)

    def suspects(self) -> list[Trial]:
        """The shortest lists of set-points for which the label may be wrong, one at most."""
        for count in range(1, LONGEST + 1):
            for path, (points, label, truth) in explore(partial(self._few, count), self.deadline):
                flat = [part for point in points for part in point]
                values = assignment(path, label, truth, flat)
                if values is not None:
                    return [_flight(values, self.track)]
        return []

    def _few(self, count: int, path: Path) -> tuple[list[Any], Value, Value]:
        """Some set-points, with the label and the truth after them."""
        rest = self.platform.rest.arguments[0][1]
        points = [self._points(path)[1] for _ in range(count)]
        world = self.world.initial
        for point in points:
            world = self._moved(path, world, point)
        history = History(first=rest, known=[rest, *points])
        label = self._label(path, history, points[-1], history.item(-2), Loops())
        return points, label, self.world.truth(path, world).get(self.name)

    def _label(
        self, path: Path, history: History, current: Value, previous: Value, loops: Loops
    ) -> Value:
        supply = {"history": history, "current": current, "previous": previous}
        program = Program(self.tree, self.platform, path, loops)
        kwargs = {parameter: supply[kind] for parameter, kind in self.kinds}
        try:
            return program.label(self.name, kwargs, program.names.found)
        except PythonError as error:
            raise NotUnderstoodError(f"{self.name} may raise {error}") from error

    def _points(self, path: Path) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """The last set-point so far, and one more."""
        size = range(self.track.parameters[0].size or 0)
        last = tuple(path.fresh(f"last{i}") for i in size)
        return last, tuple(path.fresh(f"point{i}") for i in size)

    def _remembered(self, robot: Quantities, last: tuple[Any, ...]) -> tuple[Any, ...]:
        """The last set-point, where the robot's state has it; that spares the solver work."""
        same = {g[2]: robot[g[1]] for g in self.guesses if g[0] == "==" and g[1] in robot}
        return tuple(same.get(name, part) for name, part in of_point(last).items())

    def _moved(self, path: Path, world: Value, point: Value) -> Value:
        issued = issued_record(self.track.name, {self.track.parameters[0].name: point})
        return self.world.step(path, world, issued)


def _flight(values: Sequence[Any], track: Command) -> Trial:
    """A run along set-points."""
    size = track.parameters[0].size or 1
    points = [tuple(values[i : i + size]) for i in range(0, len(values), size)]
    return Trial(tuple(Send(track.issue((point,), {}), True) for point in points))
