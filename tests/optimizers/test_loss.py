import pytest

import vaso
from vaso.errors import ModelError, PlanError
from vaso.gradient.model import Level
from vaso.modules import SymbolicPlanner
from vaso.optimizers.base import Case
from vaso.optimizers.budget import BudgetExhausted
from vaso.optimizers.loss import SkillLoss
from vaso.optimizers.parameters import Parameters
from vaso.plan import Plan
from vaso.skill_file import load_skill, load_tasks

DRIVE = load_skill("drive", version="initial")
CASE = Case(load_tasks("drive").seen[0])
START = Parameters(DRIVE)
GOOD = DRIVE.plan_template.replace("break", "stop()")


def loss(planner=None, **options):
    return SkillLoss(DRIVE, planner or SymbolicPlanner(), **options)


def with_(**texts):
    return START.replace(texts)


def test_the_faulty_template():
    value = loss()(START, CASE)
    assert value.score == 0.75 and not value.verified and value.completion == 1.0
    assert value.violated == ("F(!people_observed & !obstacle_observed) -> F(!stop)",)
    assert "violates F(!people_observed" in str(value.gradient)
    assert "violates" in value.feedback["plan_template"]


def test_a_repaired_template():
    value = loss()(with_(plan_template=GOOD), CASE)
    assert value.verified and value.completion == 1.0 and value.feedback == {}
    assert str(value.gradient) == "pass all specifications"


@pytest.mark.parametrize("level", list(Level))
def test_levels(level):
    text = str(loss(level=level)(START, CASE).gradient)
    assert ("step" in text) == (level is not Level.VERDICT)
    assert ("A verified repair" in text) == (level is Level.REPAIR)


def test_the_repair_in_a_gradient_is_verified():
    edit = loss(level="repair")(START, CASE).gradient.repair
    assert edit is not None and vaso.verify(DRIVE, edit.after)


@pytest.mark.parametrize(
    ("texts", "name", "message"),
    [
        ({"plan_template": "while True\n  stop()"}, "plan_template", "line 1"),
        ({"plan_template": "fly_away()"}, "plan_template", "fly_away"),
        ({"labelling_code": "def x(:"}, "labelling_code", "line 1"),
        ({"local_rule": "G(("}, "local_rule", "LTL"),
        ({"local_rule": "G(people_observed -> X forward)"}, "local_rule", "conflicts"),
    ],
)
def test_malformed_texts_are_a_value(texts, name, message):
    value = loss()(with_(**texts), CASE)
    assert value.score == 0.0 and message in value.feedback[name]
    assert message in str(value.gradient) and not value.verified


def test_labels_that_lie_are_a_value():
    code = DRIVE.labelling_code.replace('yolo_listener("people")', "False")
    value = loss()(with_(labelling_code=code), CASE)
    assert value.score == 0.0 and "people_observed" in value.feedback["labelling_code"]


def test_a_plan_that_only_stops_is_safe_and_useless():
    value = loss()(with_(plan_template="while True:\n    stop()"), CASE)
    assert value.completion == 0.0 and value.lost == ("forward is executed never",)


def test_a_broken_first_version_is_judged_by_what_it_names():
    broken = DRIVE.model_copy(update={"plan_template": GOOD.replace(":\n", "\n", 1)})
    found = SkillLoss(broken, SymbolicPlanner())
    params = Parameters(broken)
    assert found(params, CASE).score == 0.0
    assert found(params.replace({"plan_template": GOOD}), CASE).completion == 1.0
    assert found(params.replace({"plan_template": "stop()"}), CASE).completion == 0.0


def test_nothing_is_drawn_verified_or_checked_twice():
    drawn, verified, checked = [], [], []

    def planner(skill, task):
        drawn.append((skill.plan_template, task))
        return SymbolicPlanner()(skill, task)

    def verify(skill, plan):
        verified.append(plan.source)
        return vaso.verify(skill, plan)

    def check(skill):
        checked.append(skill.rules)
        return vaso.check(skill)

    counted = loss(planner, verify=verify, check=check)
    cases = [Case(task) for task in load_tasks("drive").seen]
    for params in (START, with_(plan_template=GOOD), START, with_(plan_template=GOOD)):
        for case in cases:
            counted(params, case)
    assert len(drawn) == len(set(drawn)) == 10
    assert len(verified) == len(set(verified)) == counted.verifications == 2  # equal plans
    assert len(checked) == 1


def test_the_plans_survive_a_checkpoint():
    first = loss()
    first(START, CASE)

    def no_planner(skill, task):
        raise AssertionError("the plan was drawn before")

    second = loss(no_planner)
    second.restore(first.state())
    assert second(START, CASE).score == 0.75


@pytest.mark.parametrize("error", [ValueError("odd"), PlanError("no plan"), KeyError("x")])
def test_a_planner_that_fails_is_a_value(error):
    def planner(skill, task):
        if skill.plan_template == GOOD:
            raise error
        return SymbolicPlanner()(skill, task)

    value = loss(planner)(with_(plan_template=GOOD), CASE)
    assert value.score == 0.0 and str(error.args[0]) in value.error


@pytest.mark.parametrize("error", [ModelError("down"), BudgetExhausted("spent")])
def test_a_model_that_fails_is_nobodys_fault(error):
    def planner(skill, task):
        raise error

    with pytest.raises(type(error)):
        loss(planner)(START, CASE)


def test_a_planner_may_be_a_dspy_module():
    class Prediction:
        plan = Plan(source=GOOD)

    assert loss(lambda skill, task: Prediction())(START, CASE).verified


def test_values_are_kept_small_and_can_be_completed():
    found = loss()
    value = found(START, CASE)
    assert value.result is not None and value.result.system is None
    full = found.with_system(START, value)
    assert full.result is not None and len(full.result.system.states) == value.result.states
