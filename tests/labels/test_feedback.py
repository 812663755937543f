"""A wrong label is feedback on the labelling code, and the optimizers use it."""

from dataclasses import dataclass, field

import pytest
from label_samples import DRIVE, SQUARE, changed

import vaso
from vaso.gradient import textual_gradient
from vaso.labels import compare_states, label_feedback
from vaso.modules import SymbolicPlanner
from vaso.optimizers import Budget, optimize
from vaso.optimizers.base import Case, Proposal
from vaso.optimizers.loss import SkillLoss
from vaso.optimizers.parameters import Parameters
from vaso.plan import compile_plan
from vaso.platforms import get_platform

TASK = "Move forward for 5 meters."
BLIND = changed(DRIVE, 'yolo_listener("people")', 'yolo_listener("person")')
FLAT = changed(SQUARE, "plan[-1][1], plan[-1][2])", "plan[-1][1])")


def value_of(skill, start=None):
    loss = SkillLoss(start or skill, SymbolicPlanner())
    params = Parameters(start or skill).replace({"labelling_code": skill.labelling_code})
    return loss(params, Case(TASK))


def test_the_feedback_names_witness_and_what_it_hides():
    system = compile_plan(BLIND.plan_template, BLIND)
    rules = [r.formula for r in BLIND.rules]
    told = label_feedback(compare_states(system, get_platform("jackal"), rules))
    assert told.startswith("the labels do not tell the truth about the robot: people_observed\n")
    assert "people_observed: the code says" in told and "yolo_listener('person') is" in told
    assert "although the robot violates it" in told


def test_a_gradient_of_a_pass_over_wrong_labels_is_no_pass():
    gradient = textual_gradient(vaso.verify(BLIND, BLIND.plan_template), skill=BLIND)
    assert not gradient.passed and "people_observed: the code says" in str(gradient)


def test_wrong_labels_from_the_start_are_not_verified():
    value = value_of(BLIND)
    assert not value.verified and value.score == 0.5  # two of four rules rest on them
    assert list(value.feedback) == ["labelling_code"]
    assert "people_observed: the code says" in value.feedback["labelling_code"]


def test_a_new_lie_is_turned_down_with_its_witness():
    value = value_of(BLIND, start=DRIVE)
    assert value.score == 0.0 and "people_observed: the code says" in value.error


def test_a_lie_that_the_plan_does_not_show_is_turned_down():
    value = value_of(changed(DRIVE, "linear=-0.3", "linear=0.25"), start=DRIVE)
    assert value.score == 0.0 and "backward()" in value.error


@pytest.mark.slow
def test_labels_put_right_never_lower_the_score():
    before = value_of(FLAT)
    after = value_of(SQUARE, start=FLAT)
    assert before.score < after.score == 1.0 and after.feedback == {}


@dataclass
class Reader:
    """A proposer that reads the feedback on the labelling code, and does what it says."""

    name: str = "reader"
    needs_lm: bool = False
    deterministic: bool = True
    read: list[str] = field(default_factory=list)

    def propose(self, state):
        for _, value in state.failing:
            told = value.feedback.get("labelling_code", "")
            self.read.append(told)
            if "yolo_listener('people') is" in told:
                code = state.params["labelling_code"].replace('"person"', '"people"')
                yield Proposal({"labelling_code": code}, "looks for people")


def test_an_optimizer_gets_the_feedback_and_puts_the_label_right():
    reader = Reader()
    result = optimize(BLIND, [TASK], optimizer=reader)
    assert result.verified and result.skill.labelling_code == DRIVE.labelling_code
    assert "people_observed: the code says" in reader.read[0]
    assert "people_observed: the code says" in result.steps[0].gradient


@pytest.mark.slow
def test_a_model_gets_the_feedback():
    from vaso.modules import EditModel

    asked = []

    class Listening(EditModel):
        def __call__(self, *args, **kwargs):
            asked.append(str(kwargs.get("messages") or args))
            return super().__call__(*args, **kwargs)

    optimize(BLIND, [TASK], optimizer="loop", lm=Listening(), budget=Budget(steps=1))
    assert asked and all("people_observed: the code says" in text for text in asked)


def test_repair_does_not_search_plans_for_what_only_labels_can_mend():
    result = optimize(BLIND, [TASK], optimizer="repair")
    assert not result.verified and result.spent.loss_calls <= 2
