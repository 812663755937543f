"""Simulation test: what CPython does under scripted sensors is a run of the explored automaton."""

from __future__ import annotations

import textwrap

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.plan.contracts import DRIVE, JACKAL_CODE
from tests.plan.reference import Reference
from vaso.plan import Budget, compile_plan
from vaso.platforms import get_platform

JACKAL = get_platform("jackal")
PEOPLE, OBSTACLE = "yolo_listener('people')", "yolo_listener('obstacle')"

ACTIONS = st.sampled_from(
    ["forward()", "stop()", "turn_left()", "backward()", "act()", "robot.go()"]
)
TESTS = st.sampled_from(
    [
        "people_observed()",
        "obstacle_observed()",
        "people_observed() and not obstacle_observed()",
        "n < 2",
        "seen",
        "len(log) % 2 == 0",
        "time.time() - start < 0.35",
        "count() > 2",
    ]
)
SIMPLE = st.one_of(
    ACTIONS,
    st.sampled_from(
        [
            "n += 1",
            "n = 0",
            "seen = people_observed()",
            "seen = seen or obstacle_observed()",
            "log.append(n)",
            "log = log[-2:]",
            "time.sleep(0.1)",
            "time.sleep(0.25)",
            "memory['last'] = people_observed()",
            "count()",
            "robot.n = (robot.n + 1) % 3",
            "pass",
        ]
    ),
)
HEAD = """
import time
n, seen, log, memory, start = 0, False, [], {}, time.time()
def make():
    total = 0
    def inner():
        nonlocal total
        total = min(total + 1, 4)
        return total
    return inner
count = make()
def act(k=1, *, loud=False):
    for i in range(k):
        if people_observed():
            stop()
            return None
        forward()
class Robot:
    def __init__(self):
        self.n = 0
    def go(self):
        if self.n % 2:
            turn_right()
        else:
            forward()
robot = Robot()
"""


def _block(lines: list[str]) -> str:
    return textwrap.indent("\n".join(lines) or "pass", "    ")


def _compound(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    body = st.lists(inner, min_size=1, max_size=3).map(_block)
    return st.one_of(
        st.tuples(TESTS, body, body).map(lambda t: f"if {t[0]}:\n{t[1]}\nelse:\n{t[2]}"),
        st.tuples(st.integers(1, 3), body).map(lambda t: f"for i in range({t[0]}):\n{t[1]}"),
        body.map(lambda b: f"for word in ['a', 'b']:\n{b}"),
        body.map(lambda b: f"try:\n{b}\n    1 / (n - 1)\nexcept ZeroDivisionError:\n    stop()"),
        st.tuples(TESTS, body).map(
            lambda t: (
                f"while {t[0]}:\n{t[1]}\n    forward()\n    if n > 3 or people_observed():\n        break"
            )
        ),
        body.map(
            lambda b: (
                f"for i, word in enumerate([1, (2, 3)]):\n{b}\n    if seen: continue\n    stop()"
            )
        ),
    )


PLANS = st.lists(st.recursive(SIMPLE, _compound, max_leaves=8), min_size=1, max_size=5).map(
    lambda parts: HEAD + "\n".join(parts) + "\n"
)
VALUATIONS = st.lists(
    st.fixed_dictionaries({PEOPLE: st.booleans(), OBSTACLE: st.booleans()}),
    min_size=12,
    max_size=12,
)


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)
@given(plan=PLANS, scripts=st.lists(VALUATIONS, min_size=4, max_size=4))
def test_every_run_in_cpython_is_a_run_of_the_automaton(plan, scripts):
    system = compile_plan(plan, DRIVE, budget=Budget(states=400, seconds=10))
    system.check_total()
    for script in scripts:
        expected = Reference(JACKAL, script).run(JACKAL_CODE, plan)
        state = 0
        for step, valuation in enumerate(script):
            if system.states[state].cut:
                break
            assert system.states[state].command == expected[step], f"step {step}\n{plan}"
            state = system.step(state, valuation).target
