"""Simulation test: what CPython does under scripted sensors is a run of the automaton, and back."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from vaso.evidence.clocks import random_clock_plan
from vaso.evidence.cpython import run_in_cpython
from vaso.evidence.programs import random_plan, random_trajectory
from vaso.evidence.simulation import compare_run, covering_scripts, random_scripts
from vaso.plan import Budget, compile_plan
from vaso.skill_file import load_skill

JACKAL = load_skill("find-object")
PX4 = load_skill("fly-in-square-shape-traj")
BUDGET = Budget(states=150, seconds=20)
RANDOM = st.randoms(use_true_random=False)
PEOPLE, OBSTACLE, TARGET = (f"yolo_listener('{n}')" for n in ("people", "obstacle", "target"))


def check(plan, skill, random, runs=3, edges=10) -> None:
    system = compile_plan(plan, skill, budget=BUDGET)
    system.check_total()
    scripts = random_scripts(system, random, runs, 20)
    for script in [*scripts, *covering_scripts(system, random, extra=4, most=edges)]:
        mismatch = compare_run(system, plan, skill, script)
        assert mismatch is None, f"{mismatch}\n{plan}"


def examples(count: int):
    return settings(
        max_examples=count,
        deadline=None,
        derandomize=True,
        phases=[Phase.generate, Phase.shrink],  # explaining traces lines, as the comparison does
        suppress_health_check=list(HealthCheck),
    )


@examples(12)
@given(RANDOM)
def test_random_plans_behave_in_cpython_as_in_the_automaton(random):
    check(random_plan(random), JACKAL, random)


@examples(12)
@given(RANDOM)
def test_random_plans_with_clocks_behave_in_cpython_as_in_the_automaton(random):
    check(random_clock_plan(random), JACKAL, random, runs=4, edges=8)


@examples(10)
@given(RANDOM)
def test_random_trajectories_behave_in_cpython_as_in_the_automaton(random):
    check(random_trajectory(random), PX4, random, runs=1, edges=1)


@pytest.mark.slow
@pytest.mark.timeout(3600)
@examples(1500)
@given(RANDOM)
def test_many_random_plans(random):
    check(random_plan(random), JACKAL, random, runs=8, edges=60)


@pytest.mark.slow
@pytest.mark.timeout(3600)
@examples(1500)
@given(RANDOM)
def test_many_random_plans_with_clocks(random):
    check(random_clock_plan(random), JACKAL, random, runs=10, edges=60)


@pytest.mark.parametrize("name", ["drive", "find-object", "bypass-object"])
def test_every_edge_of_a_shipped_template_is_followed_by_cpython(name):
    skill = load_skill(name)
    plan = skill.plan_template
    system = compile_plan(plan, skill)
    for script in covering_scripts(system, Random(1), extra=5, most=10):
        assert compare_run(system, plan, skill, script) is None


def test_the_comparison_notices_another_command_another_label_and_another_sensor():
    plan = "while True:\n    stop() if people_observed() else forward()\n"
    system = compile_plan(plan, JACKAL)
    script = [{s.name: False for s in system.sensors}] * 3
    assert compare_run(system, plan, JACKAL, script) is None
    slower = compare_run(system, plan.replace("forward", "backward"), JACKAL, script)
    assert slower is not None and slower.step == 1 and "sends" in slower.what
    liar = JACKAL.labelling_code.replace("return CURRENT_SPEED", "return 0.25")
    other = compare_run(system, plan, JACKAL.model_copy(update={"labelling_code": liar}), script)
    assert other is not None and "'speed' is 0.25" in other.what
    door = compare_run(
        system, plan.replace("people_observed()", "yolo_listener('door')"), JACKAL, script
    )
    assert door is not None and "door" in door.what


def test_cpython_follows_the_meaning_of_a_step():
    """By hand: rest, a read in state t decides state t + 1, a sleep, the end."""
    plan = (
        "if people_observed():\n    forward()\ntime.sleep(0.15)\n"
        "while people_observed():\n    pass\nbackward()\n"
    )
    seen = [True, False, False, True, True, False, False, False]
    samples = run_in_cpython(
        plan, JACKAL, [{PEOPLE: s, OBSTACLE: False, TARGET: False} for s in seen]
    )
    actions = ["forward", "backward", "stop"]
    shown = [next(a for a in actions if s.labels[a]) for s in samples]
    assert shown == ["stop", *["forward"] * 5, "backward", "backward"]
    assert [s.labels["people_observed"] for s in samples] == seen


def test_a_plan_that_computes_for_ever_ends_the_comparison():
    plan = "forward()\nwhile True:\n    pass\n"
    system = compile_plan("forward()\n", JACKAL)
    script = [{s.name: False for s in system.sensors}] * 4
    mismatch = compare_run(system, plan, JACKAL, script)
    assert mismatch is not None and "without a command" in mismatch.what
