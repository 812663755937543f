from dataclasses import replace

import pytest
from label_samples import DRIVE, SQUARE, changed, with_labels

import vaso
from vaso.labels import LabelStatus, compare_states
from vaso.plan import Budget, compile_plan
from vaso.platforms import Issued, Platform, PropositionSpec, get_platform


def compared(skill, plan=None, **options):
    system = compile_plan(plan or skill.plan_template, skill, **options)
    rules = [r.formula for r in (*skill.rules, *skill.assumptions)]
    return compare_states(system, get_platform(skill.platform), rules)


@pytest.mark.parametrize("name", vaso.shipped_skills())
def test_shipped_templates(name):
    report = compared(vaso.load_skill(name))
    assert report.agree is True
    assert f"in all {report.states} states of this plan" in report.line


def test_a_witness_names_step_and_line():
    skill = changed(SQUARE, "z - down * dt", "z + down * dt")
    witness = compared(skill, "plan = [(0.0, 0.0, -0.5)] * 2\n").differing[0].witness
    assert str(witness) == (
        "altitude: the code says 0.0, the robot has 0.5 in step 1 of the plan: "
        "line 1 runs set_velocity(velocity=(0.0, 0.0, -0.5))"
    )


def test_a_stop_that_does_not_stop_is_shown_by_its_own_call():
    skill = changed(DRIVE, "linear=0.0, angular=0.0", "linear=0.1, angular=0.0")
    found = {c.name: c.witness for c in compared(skill).wrong}
    assert found["stop"].says is True and "stop()" in found["stop"].situation


def test_a_plan_with_a_cut_is_not_validated():
    report = compared(DRIVE, budget=Budget(states=5))
    assert report.agree is None and "not explored further" in report.line


def test_what_no_rule_mentions_does_not_count():
    skill = changed(DRIVE, "linear=-0.3", "linear=0.3")
    report = compared(skill, "backward()\nstop()")
    assert [c.name for c in report.wrong] == ["backward"] and report.agree is True
    assert "wrong, but in no rule: backward" in report.line


def test_a_number_that_depends_on_a_sensor():
    code = changed(
        DRIVE, "return CURRENT_SPEED", 'return 9.0 if yolo_listener("x") else CURRENT_SPEED'
    )
    witness = compared(code).differing[0].witness
    assert witness.says == 9.0 and "yolo_listener('x') is True" in witness.situation


class Still:
    """Dynamics that say nothing."""

    def initial(self):
        return 0

    def step(self, state, command):
        return 0

    def truth(self, state):
        return {}


def test_actions_that_exclude_each_other_are_compared_without_any_truth():
    jackal = get_platform("jackal")
    robot = jackal.model_copy(update={"dynamics": Still(), "name": "still"})
    skill = changed(
        DRIVE, "set_velocity(linear=0.0, angular=-0.5)", "set_velocity(linear=0.0, angular=0.5)"
    )
    system = compile_plan("turn_left()", skill, platform=robot)
    report = compare_states(system, robot, [])
    assert [c.name for c in report.wrong] == ["turn_right"]


def test_readings_that_are_no_truth_values():
    domain = (0, 1, 2)
    jackal = get_platform("jackal")
    sensor = jackal.sensors[0].model_copy(update={"domain": domain})
    robot = jackal.model_copy(update={"sensors": (sensor,)})
    skill = with_labels(DRIVE, 'def people_observed():\n    return yolo_listener("people") > 0\n')
    system = compile_plan(
        "stop_() if people_observed() else None",
        with_labels(DRIVE, skill.labelling_code + "\ndef stop_():\n    velocity_publisher(0, 0)\n"),
        platform=robot,
    )
    report = compare_states(system, robot, [])
    assert not report.wrong


# -- in a verification -----------------------------------------------------------------------------


def test_a_pass_over_wrong_labels_says_so_everywhere():
    skill = changed(DRIVE, 'yolo_listener("people")', 'yolo_listener("person")')
    result = vaso.verify(skill, skill.plan_template)
    assert result.verdict.value == "pass" and result.labels.agree is False
    for text in (repr(result), result.to_json()["labels"]["text"], result._repr_html_()):
        assert "labels differ from the robot" in text


def test_a_result_without_labels_says_that_they_are_not_validated():
    result = replace(vaso.verify(DRIVE, DRIVE.plan_template), labels=None)
    assert "labels not validated" in repr(result)
    assert result.to_json()["labels"] == {"agree": None, "text": "labels not validated"}
    assert "labels not validated" in result._repr_html_()


def test_an_unknown_platform_of_numbers():
    robot = Platform(
        name="bare",
        dt=1.0,
        commands=(),
        rest=Issued(name="rest"),
        dynamics=Still(),
        propositions=(PropositionSpec(name="calm", kind="numeric"),),
    )
    skill = with_labels(DRIVE, "def calm():\n    return 1.0\n").model_copy(
        update={"global_rules": (vaso.Rule(text="G(calm < 2)"),), "local_rules": ()}
    )
    report = vaso.verify(skill, "x = 1", platform=robot).labels
    assert report.agree is None and "say nothing of it" in report.line
    assert report.unvalidated[0].status is LabelStatus.INCOMPARABLE
