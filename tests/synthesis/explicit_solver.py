"""A second opinion on games: monitors written by hand, and fixpoints over sets of states.

It shares nothing with the package but the shape of the question. Rules come from a fixed list of
patterns, each with its own little automaton. The game is solved by the three nested fixpoints of
Piterman, Pnueli & Sa'ar (Synthesis of Reactive(1) Designs, 2006) on explicit positions.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

Memory = object
Step = Callable[[Memory, set[str]], Memory]


@dataclass(frozen=True)
class Pattern:
    """A rule as text, and as an automaton over the sets of propositions that hold."""

    text: str
    start: Memory
    step: Step
    good: Callable[[Memory], bool]


def response(p: str, a: str) -> Pattern:
    def step(waiting, now):
        return (waiting or p in now) and a not in now

    return Pattern(f"G({p} -> F {a})", False, step, lambda waiting: not waiting)


def following(p: str, a: str, *, negated: bool = False) -> Pattern:
    sign = "!" if negated else ""

    def step(memory, now):
        if memory == "lost" or (memory == "asked" and (a in now) == negated):
            return "lost"
        return "asked" if p in now else ""

    return Pattern(f"G({p} -> X {sign}{a})", "", step, lambda memory: memory != "lost")


def never_together(p: str, a: str) -> Pattern:
    def step(lost, now):
        return lost or (p in now and a in now)

    return Pattern(f"X G !({p} & {a})", None, skip_first(step), lambda lost: lost is not True)


def together(p: str, a: str) -> Pattern:
    def step(lost, now):
        return lost or (p in now and a not in now)

    return Pattern(f"X G({p} -> {a})", None, skip_first(step), lambda lost: lost is not True)


def skip_first(step):
    return lambda memory, now: False if memory is None else step(memory, now)


def often(a: str) -> Pattern:
    return Pattern(f"G F {a}", False, lambda _, now: a in now, bool)


def often_not(a: str) -> Pattern:
    return Pattern(f"G F !{a}", False, lambda _, now: a not in now, bool)


def once(a: str) -> Pattern:
    return Pattern(f"F {a}", False, lambda done, now: done or a in now, bool)


def answer(p: str, a: str) -> Pattern:
    def step(memory, now):
        asked, done = memory
        return asked or p in now, done or a in now

    return Pattern(f"F {p} -> F {a}", (False, False), step, lambda m: not m[0] or m[1])


def for_ever(p: str, a: str) -> Pattern:
    def step(memory, now):
        if memory == "lost" or (memory == "stay" and a not in now):
            return "lost"
        return "stay" if memory == "stay" or p in now else ""

    return Pattern(f"G({p} -> X G {a})", "", step, lambda memory: memory != "lost")


def robot_wins(
    sensors: Sequence[str],
    actions: Sequence[str],
    rest: str,
    assumptions: Sequence[Pattern],
    rules: Sequence[Pattern],
) -> bool:
    """Whether the robot, choosing its action before it sees the sensors of the step, wins."""
    inputs = [
        frozenset(itertools.compress(sensors, bits))
        for bits in itertools.product((0, 1), repeat=len(sensors))
    ]
    watched = [*assumptions, *rules]

    def follow(memories, given, action):
        now = {*given, action}
        return tuple(p.step(m, now) for p, m in zip(watched, memories, strict=True))

    # A position is (action of this step, memories before this step, sensors of this step).
    start = [(rest, tuple(p.start for p in watched), e) for e in inputs]
    positions, todo = {}, list(start)
    while todo:
        position = todo.pop()
        if position in positions:
            continue
        action, memories, given = position
        later = follow(memories, given, action)
        positions[position] = [[(a, later, e) for e in inputs] for a in actions]
        todo += [p for choice in positions[position] for p in choice]

    count = len(assumptions)
    fair = [{p for p in positions if watched[i].good(p[1][i])} for i in range(count)]
    goals = [{p for p in positions if watched[i].good(p[1][i])} for i in range(count, len(watched))]
    everything = set(positions)
    unfair = [everything - f for f in fair] or [set()]

    def forced(target):
        return {p for p, choices in positions.items() if any(target.issuperset(c) for c in choices)}

    winning = set(everything)
    while True:
        before = set(winning)
        for goal in goals:
            winning &= _attractor(goal & forced(winning), unfair, forced, everything)
        if winning == before:
            return all(p in winning for p in start)


def _attractor(base, unfair, forced, everything):
    reached: set = set()
    while True:
        before = set(reached)
        wanted = base | forced(reached)
        for waiting in unfair:
            trapped = set(everything)
            while True:
                smaller = wanted | (waiting & forced(trapped))
                if smaller == trapped:
                    break
                trapped = smaller
            reached |= trapped
        if reached == before:
            return reached
