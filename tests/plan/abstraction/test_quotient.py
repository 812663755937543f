"""Exploration with numbers seen only as far as they matter, against exploration with all of them."""

from __future__ import annotations

import random
import textwrap

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.plan.contracts import DRIVE
from vaso.plan import Budget, compile_plan, explore
from vaso.plan.transition_system import TransitionSystem

TESTS = st.sampled_from(
    [
        "people_observed()",
        "obstacle_observed() and not people_observed()",
        "time.time() - t0 < 0.35",
        "(time.time() - t0) - paused < 0.4",
        "time.time() < end",
        "now - t1 > 0.2",
        "n < 3",
        "n % 2 == 0",
        "n == m",
        "m",
        "not acc",
        "acc > 0.25 or people_observed()",
        "0 < n <= m + 1",
        "t1 is None",
        "t1 is not None and time.time() - t1 >= 0.3",
        "elapsed() < 0.3",
        "flag",
        "robot.late()",
        "pick() > 2 and robot.since() < 0.3",
    ]
)
SIMPLE = st.sampled_from(
    [
        "forward()",
        "stop()",
        "turn_left()",
        "act()",
        "act(2)",
        "wait()",
        "robot.go()",
        "time.sleep(0.2)",
        "t0 = time.time()",
        "now = time.time()",
        "t1 = time.time()",
        "t1 = None",
        "t1 = now = time.time()",
        "end = time.time() + 0.3",
        "end += 0.2",
        "paused += time.time() - now",
        "paused = 0",
        "acc += time.time() - now; now = time.time()",
        "acc -= 0.1",
        "acc = max(0, acc - 0.1)",
        "n += 1",
        "n -= 1",
        "n, m = m, n",
        "m = n + 2",
        "m = n * 2",
        "n = 0",
        "n = int(acc * 10)",
        "flag = people_observed()",
        "flag = n > 2",
        "flag = time.time() - t0 > 0.3",
        "memory['t'] = n",
        "n = memory.get('t', 0)",
        "print(f'{n} {time.time() - t0:.1f}', acc)",
        "tick()",
        "m = spent(now)",
        "t0 += spent(now)",
        "n = pick()",
        "n = robot.lap()",
        "m = robot.lap(longer=n * 0.1)",
        "robot.laps = 0",
        "robot.begun = t0",
        "m = robot.since()",
        "acc = sum(map(double, [n, 1]))",
        "n, m = pair()",
        "m = [k for k in range(4) if k < n][-1:]",
    ]
)
HEAD = """
import time
n, m, acc, paused, flag, memory = 0, 2, 0.0, 0, False, {}
t0 = now = end = time.time()
t1 = None
def act(k=1, *, rest=0.1):
    begun = time.time()
    while time.time() - begun < k * rest:
        forward()
        if people_observed():
            stop()
            return
def elapsed():
    return time.time() - t0
def wait():
    global paused
    begin = time.time()
    while people_observed():
        stop()
    paused += time.time() - begin
def tick():
    global n
    n += 1
def spent(since, scale=1):
    if since is None:
        return 0
    return (time.time() - since) * 1
def make():
    begun = time.time()
    def late():
        nonlocal begun
        if time.time() - begun > 0.2:
            begun = time.time()
            return True
        return False
    return late
pick = lambda: m if isinstance(m, int) else 1
def double(k):
    return k + n
def pair():
    return n + 1, m
class Robot:
    def lap(self, longer=0):
        if time.time() - self.begun > 0.25 + longer:
            self.begun = time.time()
            self.laps += 1
        return self.laps
    def since(self):
        return time.time() - t0
    def __init__(self):
        self.late = make()
        self.n = 0
        self.laps, self.begun = 0, time.time()
    def go(self):
        self.n = (self.n + 1) % 3
        if self.n:
            turn_right()
        else:
            backward()
robot = Robot()
"""


def _indent(lines: list[str]) -> str:
    return textwrap.indent("\n".join(lines) or "pass", "    ")


def _compound(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    block = st.lists(inner, min_size=1, max_size=3).map(_indent)
    return st.one_of(
        st.builds("if {}:\n{}".format, TESTS, block),
        st.builds("if {}:\n{}\nelse:\n{}".format, TESTS, block, block),
        st.builds("while {}:\n    stop()\n{}".format, TESTS, block),
        st.builds(
            "while {}:\n{}\n    forward()\n    if n > 3:\n        break".format, TESTS, block
        ),
        st.builds("for n in range(3):\n{}\n    if {}:\n        continue".format, block, TESTS),
        st.builds("try:\n{}\n    n = n // m\nexcept ZeroDivisionError:\n{}".format, block, block),
        st.builds("try:\n{}\nfinally:\n{}".format, block, block),
    )


STATEMENTS = st.recursive(SIMPLE, _compound, max_leaves=7)
PLANS = st.lists(STATEMENTS, min_size=1, max_size=5).map(
    lambda body: f"{HEAD}while True:\n{_indent(body)}\n    forward()\n"
)
BUDGET = Budget(states=150, seconds=30)


def explored(source: str, monkeypatch: pytest.MonkeyPatch | None = None) -> TransitionSystem:
    if monkeypatch is not None:
        monkeypatch.setattr(explore, "_relevance", lambda text, known: None)
    return compile_plan(source, DRIVE, budget=BUDGET)


def follow(system: TransitionSystem, seed: int, steps: int) -> list[tuple[object, ...]]:
    """What is seen on a random run, up to where the exploration was cut."""
    rng, state, seen = random.Random(seed), 0, []
    for _ in range(steps):
        here = system.states[state]
        if here.cut:
            break
        world = {s.name: rng.choice(s.domain) for s in SENSORS}
        labels = {n: _valued(v, world) for n, v in here.labels.items()}
        seen.append((here.command, tuple(sorted(labels.items()))))
        edges = [e for e in system.edges[state] if all(world[n] == v for n, v in e.guard.items())]
        assert len(edges) == 1
        state = edges[0].target
    return seen


def _valued(label: object, world: dict[str, object]) -> object:
    if isinstance(label, tuple):
        return next(c.value for c in label if all(world[n] == v for n, v in c.guard.items()))
    return label


SENSORS = compile_plan(
    "while True:\n    forward() if people_observed() or obstacle_observed() else stop()\n", DRIVE
).sensors


@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
@given(PLANS)
def test_both_explorations_show_the_same(source):
    compare(source)


@pytest.mark.slow
@pytest.mark.timeout(1800)
@settings(max_examples=400, deadline=None, suppress_health_check=list(HealthCheck))
@given(PLANS)
def test_both_explorations_show_the_same_on_many_plans(source):
    compare(source)


def compare(source: str) -> None:
    mine = explored(source)
    with pytest.MonkeyPatch.context() as patch:
        exact = explored(source, patch)
    for seed in range(12):
        one, two = follow(mine, seed, 60), follow(exact, seed, 60)
        length = min(len(one), len(two))
        assert one[:length] == two[:length]
    assert exact.cut is not None or (mine.cut is None and len(mine.states) <= len(exact.states))
