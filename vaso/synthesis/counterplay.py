"""Sensor behaviour that defeats every plan, and how to show it.

The simplest is a fixed behaviour, a lasso of inputs along which no sequence of commands keeps the
rules, however far ahead the robot could see. Where there is none, the sensors must answer the
commands, and a play of their winning strategy is shown.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from vaso.plan.transition_system import Scalar
from vaso.synthesis.game import Game, Situation
from vaso.synthesis.strategy import Sensors, cycles, reached

__all__ = ["CounterPlay", "CounterStep", "find_lasso", "lasso_play", "strategy_play"]

MAX_PREFIX = 3
MAX_LOOP = 2
MAX_STEPS = 40


@dataclass(frozen=True, slots=True)
class CounterStep:
    """One state of a play.

    Attributes:
        sensors: What the sensors show.
        observed: What that means for the observations in the rules.
        possible: What the robot can execute in this state without breaking a rule for good.
        forbidden_by: Rules that forbid something else.
        answers: Where the sensors answer the command: what they show, by command.
    """

    sensors: Mapping[str, Scalar]
    observed: Mapping[str, Scalar]
    possible: tuple[str, ...]
    forbidden_by: tuple[str, ...] = ()
    answers: tuple[tuple[str, Mapping[str, Scalar]], ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "sensors": dict(self.sensors),
            "observed": dict(self.observed),
            "possible": list(self.possible),
            "forbidden_by": list(self.forbidden_by),
            "answers": [{"command": c, "observed": dict(o)} for c, o in self.answers],
        }


@dataclass(frozen=True)
class CounterPlay:
    """A behaviour of the sensors that defeats every plan.

    Attributes:
        steps: The states; after the last one, the sensors go on at ``steps[loop_start]``.
        loop_start: Index of the state at which the loop starts; None if a rule is broken for good.
        broken: The rules that cannot all be kept, as written.
        waiting: Those of them that wait for something that does not come about.
        fixed: True if the sensors do this whatever the robot does; else they answer its commands,
            and this is one play of many.
        strategy: The answers, where they matter.
        game: The game that the strategy is for.
    """

    steps: tuple[CounterStep, ...]
    loop_start: int | None
    broken: tuple[str, ...]
    fixed: bool
    waiting: tuple[str, ...] = ()
    strategy: Sensors | None = None
    game: Game | None = None

    def lines(self) -> list[str]:
        """One line of text a step: what is observed, and what the robot can still do."""
        rows = []
        for i, step in enumerate(self.steps):
            seen = ", ".join(f"{n} = {v}" for n, v in step.observed.items()) or "nothing observed"
            rows.append(f"step {i}: {seen}; possible: {', '.join(step.possible) or 'nothing'}")
        return rows if self.loop_start is None else [*rows, f"↺ back to step {self.loop_start}"]

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "steps": [{"step": i} | s.to_json() for i, s in enumerate(self.steps)],
            "loop_start": self.loop_start,
            "broken": list(self.broken),
            "waiting": list(self.waiting),
            "fixed": self.fixed,
        }


# --- fixed behaviour ---------------------------------------------------------------------------


def find_lasso(game: Game, deadline: float) -> tuple[list[int], int] | None:
    """Find inputs, the last of which repeat from an index on, along which the robot loses.

    Args:
        game: A game that the robot loses.
        deadline: When to give up, on the clock ``time.monotonic``.
    """
    inputs = sorted(range(len(game.arena.inputs)), key=lambda e: _weight(game, e))
    sizes = itertools.product(range(1, MAX_LOOP + 1), range(1, MAX_PREFIX + 1))
    for loop, prefix in sorted(sizes, key=sum):
        for word in itertools.product(inputs, repeat=prefix + loop):
            if time.monotonic() > deadline:
                return None
            if not _robot_can(game, word, prefix):
                return list(word), prefix
    return None


def _weight(game: Game, given: int) -> int:
    return sum(v is True for v in game.arena.observed[given].values())


def _robot_can(game: Game, word: Sequence[int], loop: int) -> bool:
    """Whether some commands keep the rules along a word, or the word breaks an assumption."""

    def following(node: tuple[int, Situation]) -> Iterator[tuple[int, Situation]]:
        position, situation = node
        later = position + 1 if position + 1 < len(word) else loop
        for a in _choices(game, position):
            after = game.after(situation, word[position], a)
            if not game.lost(after):
                yield later, after

    count = len(game.assumptions)
    if not all(_assumed(game, word, loop, i) for i in range(count)):
        return True
    graph = reached([(0, game.start)], following)
    wanted = [_accepts(game, i) for i in range(count, count + len(game.rules))]
    return any(True for _ in cycles(graph, wanted))


def _accepts(game: Game, index: int) -> Any:
    return lambda node: game.accepted(node[1])[index]


def _assumed(game: Game, word: Sequence[int], loop: int, index: int) -> bool:
    """Whether a word keeps an assumption."""
    situation, position = game.start, 0
    seen: dict[tuple[int, int], int] = {}
    path: list[bool] = []
    while (position, situation[index]) not in seen:
        seen[position, situation[index]] = len(path)
        path.append(game.accepted(situation)[index])
        situation = game.after(situation, word[position], game.arena.rest[0])
        position = position + 1 if position + 1 < len(word) else loop
    return any(path[seen[position, situation[index]] :])


def _choices(game: Game, position: int) -> tuple[int, ...]:
    return game.arena.usable if position else game.arena.rest


def lasso_play(game: Game, word: Sequence[int], loop: int) -> CounterPlay:
    """A fixed behaviour with what the robot can still do in each of its steps.

    The loop is gone through until that, too, repeats.
    """
    alive: frozenset[Situation] = frozenset({game.start})
    steps: list[CounterStep] = []
    seen: dict[frozenset[Situation], int] = {}
    position = 0
    while position != loop or alive not in seen:
        if position == loop:
            seen[alive] = len(steps)
        step, alive = _through(game, alive, word[position], first=not steps)
        steps.append(step)
        if not alive:
            return CounterPlay(tuple(steps), None, game.texts, True, _waiting(game))
        position = position + 1 if position + 1 < len(word) else loop
    steps, start = _folded(steps, seen[alive])
    return CounterPlay(tuple(steps), start, game.texts, True, _waiting(game))


def _folded(steps: list[CounterStep], loop: int) -> tuple[list[CounterStep], int]:
    """The same steps without turns of the loop that look like the one after."""
    length = len(steps) - loop
    while loop - length >= 0 and steps[loop - length : loop] == steps[loop:]:
        steps, loop = steps[:loop], loop - length
    return steps, loop


def _through(
    game: Game, alive: frozenset[Situation], given: int, *, first: bool
) -> tuple[CounterStep, frozenset[Situation]]:
    """A step, and the situations after it in which no rule is broken for good."""
    choices = game.arena.rest if first else game.arena.usable
    good, forbidding, after = set(), set(), set()
    for situation, a in itertools.product(alive, choices):
        then = game.after(situation, given, a)
        forbidding |= set(game.lost(then))
        if not game.lost(then):
            good.add(a)
            after.add(then)
    return _step(game, given, choices, good, forbidding), frozenset(after)


def _step(
    game: Game, given: int, choices: Sequence[int], good: set[int], forbidding: set[int]
) -> CounterStep:
    names = [game.arena.outputs[a] for a in choices if a in good]
    return CounterStep(
        sensors=game.arena.inputs[given],
        observed=game.arena.observed[given],
        possible=tuple(names),
        forbidden_by=tuple(game.texts[i] for i in sorted(forbidding)),
    )


def _waiting(game: Game) -> tuple[str, ...]:
    return tuple(t for t, m in zip(game.texts, game.rules, strict=True) if not m.is_safety)


# --- answers to the robot ----------------------------------------------------------------------


def strategy_play(game: Game, sensors: Sensors) -> CounterPlay:
    """A play of the sensors' strategy against a robot that keeps the rules as long as it can."""
    situation = game.start
    options = {a: sensors.start[a] for a in game.arena.rest}
    steps: list[CounterStep] = []
    seen: dict[tuple[int, int, Situation], int] = {}
    while len(steps) < MAX_STEPS:
        after = {a: game.after(situation, sensors.inputs[s], a) for a, s in options.items()}
        good = [a for a in options if not game.lost(after[a])]
        chosen = good[0] if good else next(iter(options))
        node = (options[chosen], chosen, situation)
        if node in seen:
            return _play(game, sensors, steps, seen[node])
        seen[node] = len(steps)
        steps.append(_answered(game, sensors, options, chosen, after))
        if not good:
            return _play(game, sensors, steps, None)
        situation, options = after[chosen], dict(sensors.after[options[chosen]])
    return _play(game, sensors, steps, None)


def _answered(
    game: Game,
    sensors: Sensors,
    options: Mapping[int, int],
    chosen: int,
    after: Mapping[int, Situation],
) -> CounterStep:
    shown = {a: sensors.inputs[s] for a, s in options.items()}
    broken = {i for a in options for i in game.lost(after[a])}
    alive = [a for a in options if not game.lost(after[a])]
    answers = [(game.arena.outputs[a], game.arena.observed[e]) for a, e in shown.items()]
    return CounterStep(
        sensors=game.arena.inputs[shown[chosen]],
        observed=game.arena.observed[shown[chosen]],
        possible=tuple(game.arena.outputs[a] for a in alive),
        forbidden_by=tuple(game.texts[i] for i in sorted(broken)),
        answers=tuple(answers) if len(set(shown.values())) > 1 else (),
    )


def _play(
    game: Game, sensors: Sensors, steps: Sequence[CounterStep], loop: int | None
) -> CounterPlay:
    waiting = _waiting(game)
    return CounterPlay(tuple(steps), loop, game.texts, False, waiting, sensors, game)
