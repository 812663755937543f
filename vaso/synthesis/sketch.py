"""Plans as a person would write them: a short list of cases, and at most one thing to remember.

A strategy read off a winning region is correct and hard to read. Here plans of a fixed shape are
tried, the simplest first, and each is checked against the whole game (program sketching:
Solar-Lezama, Program Sketching, 2013).
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from vaso.synthesis.game import Game
from vaso.synthesis.strategy import Robot, robot_wins

__all__ = ["Branch", "Memory", "Sketch", "Test", "find_sketch"]

MAX_BRANCHES = 4


@dataclass(frozen=True, slots=True)
class Test:
    """Something that a plan can ask the sensors.

    Attributes:
        text: The expression: ``people_observed()``.
        truth: Its value for every input.
    """

    text: str
    truth: tuple[bool, ...]


@dataclass(frozen=True, slots=True)
class Memory:
    """A flag that is set when a test holds.

    Attributes:
        test: Index of the test.
        clears: True if the flag is dropped once it has been acted on; else it stays set.
    """

    test: int
    clears: bool


@dataclass(frozen=True, slots=True)
class Branch:
    """``if test: command``.

    Attributes:
        test: Index of the test; None for the flag.
        positive: False for ``if not test``.
        command: The output to choose.
    """

    test: int | None
    positive: bool
    command: int


@dataclass(frozen=True, slots=True)
class Sketch:
    """A plan: in every step the first branch that applies, else the default.

    Attributes:
        branches: The cases.
        default: The output if none applies.
        memory: The flag, if there is one.
    """

    branches: tuple[Branch, ...]
    default: int
    memory: Memory | None = None

    def decide(self, tests: Sequence[Test], given: int, flag: bool) -> tuple[int, bool]:
        """The next output, and the flag afterwards."""
        if self.memory is not None:
            flag = flag or tests[self.memory.test].truth[given]
        for branch in self.branches:
            value = flag if branch.test is None else tests[branch.test].truth[given]
            if value == branch.positive:
                dropped = branch.test is None and self.memory is not None and self.memory.clears
                return branch.command, flag and not dropped
        return self.default, flag

    def robot(self, tests: Sequence[Test], rest: int) -> Robot:
        """The plan as a strategy."""
        nodes, after = [(rest, False)], []
        for _, flag in nodes:
            row = []
            for given in range(len(tests[0].truth) if tests else 1):
                node = self.decide(tests, given, flag)
                if node not in nodes:
                    nodes.append(node)
                row.append(nodes.index(node))
            after.append(tuple(row))
        return Robot(tuple(a for a, _ in nodes), tuple(after))


def find_sketch(
    game: Game,
    tests: Sequence[Test],
    *,
    first: Sequence[Sequence[int]],
    preferred: Sequence[int],
    deadline: float,
) -> Sketch | None:
    """Find a simple plan that wins a game.

    Args:
        game: The game; state 0 has one output only.
        tests: What a plan can ask.
        first: For each input in state 0, the outputs with which the game can still be won.
        preferred: Outputs, those first that should be done when nothing stands against them.
        deadline: When to give up, on the clock ``time.monotonic``.
    """
    usable = tests if any(t.truth for t in tests) else ()
    for default in preferred:
        for memory in _memories(len(usable)):
            for sketch in _sketches(usable, first, preferred, default, memory):
                if time.monotonic() > deadline:
                    return None
                if robot_wins(sketch.robot(usable, game.arena.rest[0]), game):
                    return sketch
    return None


def _memories(tests: int) -> Iterator[Memory | None]:
    yield None
    for clears in (True, False):
        yield from (Memory(test, clears) for test in range(tests))


def _sketches(
    tests: Sequence[Test],
    first: Sequence[Sequence[int]],
    preferred: Sequence[int],
    default: int,
    memory: Memory | None,
) -> Iterator[Sketch]:
    """Plans whose first choice is never wrong, with the fewest branches first."""
    growing = [Sketch((), default, memory)]
    for _ in range(MAX_BRANCHES + 1):
        larger = []
        for sketch in growing:
            left = _uncovered(sketch, tests, len(first))
            if all(default in first[given] for given in left) and _uses_memory(sketch):
                yield sketch
            if len(sketch.branches) < MAX_BRANCHES:
                larger += list(_extended(sketch, left, tests, first, preferred))
        growing = larger


def _uses_memory(sketch: Sketch) -> bool:
    return sketch.memory is None or any(b.test is None for b in sketch.branches)


def _uncovered(sketch: Sketch, tests: Sequence[Test], inputs: int) -> list[int]:
    """The inputs of state 0 that no branch applies to."""
    probe = replace(sketch, default=-1)
    return [e for e in range(inputs) if probe.decide(tests, e, False)[0] == -1]


def _extended(
    sketch: Sketch,
    left: Sequence[int],
    tests: Sequence[Test],
    first: Sequence[Sequence[int]],
    preferred: Sequence[int],
) -> Iterator[Sketch]:
    """The plan with one branch more, which covers something new and is right in state 0."""
    flag = [] if sketch.memory is None else [None]
    used = [b.command for b in sketch.branches]
    commands = sorted(preferred, key=lambda c: (c not in used, preferred.index(c)))
    asked = {b.test for b in sketch.branches}
    for positive in (True, False):
        for test, command in itertools.product([*range(len(tests)), *flag], commands):
            branch = Branch(test, positive, command)
            if test in asked or (test is None and not positive) or not _ordered(sketch, branch):
                continue
            longer = replace(sketch, branches=(*sketch.branches, branch))
            now_left = _uncovered(longer, tests, len(first))
            covered = set(left) - set(now_left)
            if covered and now_left and all(command in first[e] for e in covered):
                yield longer


def _ordered(sketch: Sketch, branch: Branch) -> bool:
    """Neighbours with the same command can be swapped: only one order is tried."""
    last = sketch.branches[-1] if sketch.branches else None
    if last is None or (last.command, last.positive) != (branch.command, branch.positive):
        return True
    return branch.test is None or (last.test is not None and last.test < branch.test)
