import pytest
from fakes import SKILL

import vaso
from vaso.modules import SymbolicPlanner
from vaso.optimizers import Parameters, optimize
from vaso.optimizers.base import Case, State
from vaso.optimizers.repair import Repair
from vaso.skill import shipped_skills
from vaso.skill_file import load_skill, load_tasks


def assert_really_verified(result, tasks):
    assert result.verified
    for task in tasks:
        assert vaso.verify(result.skill, SymbolicPlanner()(result.skill, task))


def test_drive_by_one_change():
    events = []
    result = optimize("drive", on_event=events.append)
    assert_really_verified(result, load_tasks("drive").seen)
    assert "replace `break` by `stop()`" in result.steps[0].note and len(result.steps) == 1
    assert result.initial_skill == load_skill("drive", version="initial")
    assert result.spent.lm_calls == 0


def test_the_square_by_one_change_of_the_climb():
    task = load_tasks("fly-in-square-shape-traj").seen[0]
    result = optimize("fly-in-square-shape-traj", [task])
    assert_really_verified(result, [task])
    assert result.steps[0].note == "line 6: replace `1` by `0.5`"
    assert "G(altitude < 10)" in result.steps[0].gradient.replace("<", " < ").replace("  ", " ")


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped_skills())
def test_every_shipped_skill_on_all_its_tasks(name):
    result = optimize(name)
    assert_really_verified(result, load_tasks(name).seen)
    assert result.completion == 1.0
    assert result.skill.global_rules == load_skill(name, version="initial").global_rules


def test_two_faults_take_two_steps():
    skill = load_skill("drive", version="initial").with_parameters(
        {"plan_template": "while True:\n    if speed() > 1:\n        stop()\n    forward()\n"}
    )
    result = optimize(skill, ["Drive straight for 3 meters and stop."], budget=6)
    safety = [result.safety_before, *(s.safety for s in result.steps)]
    assert safety == sorted(safety) and result.completion == 1.0
    assert result.verified and result.safety_before < 1


def test_says_when_it_has_nothing_more_to_propose():
    skill = load_skill("drive", version="initial").with_parameters({"plan_template": "x = 1"})
    result = optimize(skill, ["stay"], optimizer=Repair(size=1), budget=3)
    assert not result.verified and result.skill == skill
    assert result.stop_reason == "repair has nothing more to propose"


def test_a_text_that_may_not_change_is_left_alone():
    result = optimize("drive", trainable=["labelling_code"])
    assert not result.verified and result.steps[0].tried_count == 0
    assert result.stop_reason == "repair has nothing more to propose"


def test_a_template_that_does_not_parse_has_no_edits():
    params = Parameters(SKILL, changes={"plan_template": "while ("})

    class Nothing:
        result, score, verified, feedback = None, 0.0, False, {}

    state = State(1, params, {Case("x"): Nothing()}, (), None, None, lambda p, c: Nothing())
    assert list(Repair().propose(state)) == []
