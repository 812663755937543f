"""The shipped library before the real verifier: verified versions pass, initial ones do not."""

import pytest
from skill_simulation import with_constants

import vaso
from vaso.modules.symbolic import SymbolicPlanner
from vaso.skill_file import load_skill, load_tasks
from vaso.verdict import Verdict

FAULTS = {
    "bypass-object": ["F(obstacle_observed) -> F(turn_left | turn_right)"],
    "drive": ["F(!people_observed & !obstacle_observed) -> F(!stop)"],
    "find-object": ["G(target_observed -> X G stop)"],
    "fly-in-square-shape-traj": ["G(altitude < 10)", "G(velocity_change <= 1)"],
}
LONG = "bypass-object"
TASKS = [(name, task) for name in FAULTS for task in load_tasks(name).all]


@pytest.mark.parametrize("name", FAULTS)
def test_verified_versions_pass(name: str) -> None:
    skill = load_skill(name)
    plan = skill.plan_template
    if name == LONG:
        plan = with_constants(plan, {"distance_m": 0.3})
    result = vaso.verify(skill, plan)
    assert result.verdict is Verdict.PASS, [s.to_json() for s in result.failures]
    assert not result.warnings
    assert [s.spec for s in result.specs] == [r.text for r in skill.rules]


@pytest.mark.parametrize("name", FAULTS)
def test_initial_versions_fail_where_they_should(name: str) -> None:
    skill = load_skill(name, version="initial")
    result = vaso.verify(skill, skill.plan_template)
    assert [s.spec for s in result.failures] == FAULTS[name]
    for failure in result.failures:
        assert failure.verdict is Verdict.FAIL and failure.counterexample is not None


def test_the_assumption_is_named_where_it_is_needed_and_only_there() -> None:
    skill = load_skill(LONG)
    plan = with_constants(skill.plan_template, {"distance_m": 0.3})
    used = {s.spec: s.assumptions for s in vaso.verify(skill, plan).specs}
    assert used.pop(FAULTS[LONG][0]) == ("G F !people_observed",)
    assert set(used.values()) == {()}
    without = skill.model_copy(update={"assumptions": ()})
    assert [s.spec for s in vaso.verify(without, plan).failures] == FAULTS[LONG]


def test_only_the_literal_rule_9_is_vacuous() -> None:
    skill = load_skill("fly-in-square-shape-traj")
    vacuous = [s.spec for s in vaso.verify(skill, skill.plan_template).specs if s.vacuous]
    assert vacuous == ["F(linear_velocity == 0 & altitude == 0)"]


def test_one_change_of_the_climb_repairs_the_square() -> None:
    skill = load_skill("fly-in-square-shape-traj", version="initial")
    climb = "ver_speed, vert_duration_s = "
    plan = skill.plan_template.replace(f"{climb}1, 10", f"{climb}0.5, 10")
    assert vaso.verify(skill, plan)


@pytest.mark.parametrize("name", FAULTS)
def test_the_contracts_are_feasible(name: str) -> None:
    assert vaso.check(load_skill(name))


@pytest.mark.slow
@pytest.mark.parametrize(("name", "task"), TASKS)
def test_every_task_of_every_skill(name: str, task: str) -> None:
    skill = load_skill(name)
    result = vaso.verify(skill, SymbolicPlanner()(skill, task))
    assert result.verdict is Verdict.PASS, [s.to_json() for s in result.failures]
