"""From a game that the robot wins to a plan that is verified."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence

from vaso.ltl import propositions
from vaso.plan.explore import Budget
from vaso.plan.labelling import Labelling
from vaso.platforms import Platform
from vaso.skill import Skill
from vaso.synthesis.game import Game
from vaso.synthesis.probing import Probe
from vaso.synthesis.program import robot_text, sketch_text
from vaso.synthesis.sketch import Test, find_sketch
from vaso.synthesis.solver import Solution, Solver
from vaso.synthesis.strategy import robot_wins, simplified
from vaso.verdict import VerificationResult
from vaso.verification import verify

__all__ = ["Planning"]

SHARE = 0.5
"""Share of the time left that may go into making a plan easy to read."""


class Planning:
    """Writes plans for a skill.

    Args:
        skill: The skill.
        robot: Its platform.
        probed: What its labelling code does.
        game: Its game over its own commands.
        solver: Solves games, until its deadline.
    """

    def __init__(
        self, skill: Skill, robot: Platform, probed: Probe, game: Game, solver: Solver
    ) -> None:
        self._skill, self._robot, self._probed = skill, robot, probed
        self._game, self._solver = game, solver
        self._solution: Solution | None = None

    def wins(self) -> bool:
        """Whether the robot wins."""
        self._solution = self._solver.solve(self._game)
        return self._solution.realizable

    def plan(self) -> str | None:
        """The text of a plan; None if its strategy is too large to be written out."""
        assert self._solution is not None
        now = time.monotonic()
        tests, preferred = self._tests(), self._preferred()
        sketch = find_sketch(
            self._game,
            tests,
            first=self._solution.first,
            preferred=preferred,
            deadline=now + SHARE * (self._solver.deadline - now),
        )
        if sketch is not None:
            return sketch_text(sketch, tests, self._game.arena.outputs)
        robot = self._solver.solve(self._game, machine=True, order=preferred).robot
        if robot is None or not robot_wins(robot, self._game):
            return None
        now = time.monotonic()
        until = now + SHARE * (self._solver.deadline - now)
        return robot_text(simplified(robot, self._game, until), tests, self._game.arena.outputs)

    def verify(self, plan: str) -> VerificationResult:
        """Verify a plan against all rules of the skill."""
        left = max(1.0, self._solver.deadline - time.monotonic())
        return verify(
            self._skill, plan, platform=self._robot, budget=Budget(seconds=left), timeout=left
        )

    def _preferred(self) -> list[int]:
        """The commands in the order of the labelling code; those that stay at rest come last."""
        outputs, states = self._game.arena.outputs, self._probed.states
        moving = [a for a in self._game.arena.usable if states[a].labels != states[0].labels]
        assert len(outputs) == len(states)
        return moving + [a for a in self._game.arena.usable if a not in moving]

    def _tests(self) -> list[Test]:
        """What a plan can ask, without repetition, until all inputs are told apart."""
        found: list[Test] = []
        for test in self._questions():
            opposite = tuple(not v for v in test.truth)
            if len(set(test.truth)) == 2 and not any(
                t.truth in (test.truth, opposite) for t in found
            ):
                found.append(test)
        return found

    def _questions(self) -> Iterator[Test]:
        arena = self._game.arena
        functions = Labelling(self._skill.labelling_code, self._robot).functions
        for name in self._named():
            if name in functions and not functions[name].parameters:
                yield Test(f"{name}()", tuple(bool(o[name]) for o in arena.observed))
        for sensor in self._probed.sensors:
            if sensor.name not in arena.inputs[0]:
                continue
            values: Sequence[object] = [e[sensor.name] for e in arena.inputs]
            if all(isinstance(v, bool) for v in sensor.domain):
                yield Test(sensor.name, tuple(bool(v) for v in values))
                continue
            for value in sensor.domain:
                yield Test(f"{sensor.name} == {value!r}", tuple(v == value for v in values))

    def _named(self) -> list[str]:
        """The observations in the rules, in the order in which the rules name them."""
        rules = [r.formula for r in (*self._skill.rules, *self._skill.assumptions)]
        names = [n for f in rules for n in sorted(propositions(f), key=str(f).index)]
        return [n for n in dict.fromkeys(names) if n in self._game.arena.observed[0]]
