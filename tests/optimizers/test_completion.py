import math
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vaso.modules import SymbolicPlanner
from vaso.optimizers.completion import (
    Purpose,
    completion,
    purpose,
    purpose_of_text,
    read_command,
)
from vaso.optimizers.components import components, longest_weights
from vaso.plan import compile_plan
from vaso.platforms import get_platform
from vaso.skill import shipped_skills
from vaso.skill_file import load_skill, load_tasks

DRIVE = load_skill("drive", version="initial")
SQUARE = load_skill("fly-in-square-shape-traj", version="initial")
JACKAL, PX4 = get_platform("jackal"), get_platform("px4")


def of(skill, plan):
    return purpose(compile_plan(plan, skill), get_platform(skill.platform))


def kept(skill, candidate):
    return completion(of(skill, skill.plan_template), of(skill, candidate))


@pytest.mark.parametrize(
    ("plan", "score"),
    [
        (DRIVE.plan_template, 1.0),
        (DRIVE.plan_template.replace("break", "stop()"), 1.0),
        ("for i in range(30):\n    forward()\nstop()", 1.0),
        ("while True:\n    stop()", 0.0),
        ("stop()", 0.0),
        ("forward()\nstop()", 0.0),
        ("for i in range(9):\n    forward()\nstop()", 0.0),
        ("while True:\n    turn_left()", 0.0),
        (
            "while True:\n    if obstacle_observed():\n        forward()\n    else:\n        stop()",
            1.0,
        ),
    ],
)
def test_of_a_reactive_plan(plan, score):
    assert kept(DRIVE, plan)[0] == score


def test_says_what_is_lost():
    assert kept(DRIVE, "stop()")[1] == ("forward is executed never",)
    assert kept(DRIVE, "forward()\nstop()")[1] == ("forward is executed for at most 1 periods",)


def square(**changes):
    text = SQUARE.plan_template
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize(
    ("plan", "lost"),
    [
        (square(climb=("ver_speed, vert_duration_s = 1,", "ver_speed, vert_duration_s = 0.5,")), 0),
        (square(slow=("speed_mps = 0.5", "speed_mps = 0.25")), 0),
        ("vel_traj = [(0.0, 0.0, 0.0)]", 6),
        (square(gone=("vel_traj += [(-speed_mps, 0.0, 0.0)] * side_duration_s", "pass")), 1),
        (square(tiny=("side_m = 4.0", "side_m = 0.5")), 4),
        (square(low=("vert_duration_s = 1, 10", "vert_duration_s = 0.1, 10")), 2),
    ],
)
def test_of_a_trajectory(plan, lost):
    score, missing = kept(SQUARE, plan)
    assert len(missing) == lost and score == pytest.approx(1 - lost / 6)


@pytest.mark.parametrize("name", shipped_skills())
def test_the_verified_skills_keep_what_the_initial_ones_can_do(name):
    first, last, draw = load_skill(name, version="initial"), load_skill(name), SymbolicPlanner()
    task = load_tasks(name).seen[0]
    before, after = of(first, draw(first, task).source), of(last, draw(last, task).source)
    assert completion(before, after) == (1.0, ())


def test_a_plan_that_cannot_be_explored_completes_nothing():
    assert completion(Purpose({"forward": 1}), None) == (0.0, ("the plan cannot be explored",))


def test_a_reference_that_cannot_be_explored_is_read_as_text():
    found = purpose_of_text(
        "while True\n  if people_observed(): stop()\n  else: forward ()", JACKAL
    )
    assert found == Purpose({"forward": 1})
    assert completion(found, of(DRIVE, "stop()"))[0] == 0.0
    assert completion(found, of(DRIVE, DRIVE.plan_template))[0] == 1.0
    still, flies = of(SQUARE, "vel_traj = [(0.0, 0.0, 0.0)]"), of(SQUARE, SQUARE.plan_template)
    reference = purpose_of_text("vel_traj = [", PX4)
    assert completion(reference, still)[0] == 0.0 and completion(reference, flies)[0] == 1.0


def test_a_skill_that_never_did_anything_loses_nothing():
    assert completion(of(DRIVE, "stop()"), of(DRIVE, "stop()")) == (1.0, ())


@pytest.mark.parametrize(
    "text", ["", "stop", "stop()", "1 + 1", "velocity_publisher(x)", "f(", "\0"]
)
def test_a_text_that_is_no_command(text):
    assert read_command(text, JACKAL) is None


@given(st.lists(st.floats(0.05, 20), min_size=1, max_size=5), st.floats(0.2, 1))
def test_legs_as_long_or_a_fifth_as_long_are_kept(lengths, factor):
    turned = [(x, 0.0, 0.0) if i % 2 else (0.0, x, 0.0) for i, x in enumerate(lengths)]
    shorter = tuple(tuple(factor * c for c in leg) for leg in turned)
    assert completion(Purpose(legs=tuple(turned)), Purpose(legs=tuple(turned)))[0] == 1.0
    if factor > 0.2001 and len(set(lengths)) == 1:
        assert completion(Purpose(legs=tuple(turned)), Purpose(legs=shorter))[0] == 1.0


# -- longest walks --------------------------------------------------------------------------------


def brute_force(graph, heavy):
    """By walks of growing length: a count that still grows after n * n steps has a cycle."""
    nodes = len(graph)
    best = {0: int(heavy[0])}
    top = best[0]
    for length in range(nodes * nodes + nodes):
        following = {}
        for node, count in best.items():
            for target in graph[node]:
                following[target] = max(following.get(target, -1), count + heavy[target])
        best = following
        new = max(best.values(), default=0)
        if new > top:
            top = new
            if length > nodes * nodes:
                return math.inf
    return math.inf if top > nodes else top


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 10_000))
def test_longest_weights(seed):
    rng = random.Random(seed)
    nodes = rng.randint(1, 6)
    graph = [[rng.randrange(nodes) for _ in range(rng.randint(0, 2))] for _ in range(nodes)]
    heavy = [rng.random() < 0.4 for _ in range(nodes)]
    assert longest_weights(graph, heavy) == brute_force(graph, heavy)


def test_deep_graphs_need_no_recursion():
    nodes = 50_000
    graph = [[i + 1] for i in range(nodes)] + [[]]
    assert longest_weights(graph, [True] * (nodes + 1)) == nodes + 1
    assert sum(1 for _ in components(graph)) == nodes + 1
