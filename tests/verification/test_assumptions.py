"""Environment assumptions: named where they are needed, refused where they assume too much."""

import pytest

from vaso import load_skill, verify
from vaso.errors import SkillError
from vaso.ltl import holds, parse
from vaso.skill import Rule
from vaso.verdict import Verdict
from vaso.verifiers import Answer, AutoVerifier

BYPASS, DRIVE = load_skill("bypass-object"), load_skill("drive")
PATIENT = "while people_observed():\n    stop()\nforward()\n"
WAITS = """
while True:
    while people_observed():
        stop()
    while obstacle_observed():
        stop()
    forward()
"""


def assuming(*texts: str, skill=DRIVE):
    rules = tuple(Rule(text=t, role="assumption") for t in texts)
    return skill.model_copy(update={"assumptions": rules, "global_rules": (), "local_rules": ()})


def check(plan: str, spec: str, *assumptions: str, **options):
    return verify(assuming(*assumptions), plan, specs=[spec], **options).specs[0]


def test_a_pass_names_the_assumption_that_it_needs():
    assert check(PATIENT, "F forward").verdict is Verdict.FAIL
    result = check(PATIENT, "F forward", "G F !people_observed")
    assert result.verdict is Verdict.PASS and result.assumptions == ("G F !people_observed",)


def test_a_pass_that_needs_none_names_none():
    result = check(PATIENT, "G(speed < 0.5)", "G F !people_observed")
    assert result.verdict is Verdict.PASS and result.assumptions == ()


def test_only_the_assumptions_that_are_needed_are_named():
    both = ("G F !people_observed", "G F !obstacle_observed")
    assert check(PATIENT, "F forward", *both).assumptions == both[:1]
    needs_both = "G F !people_observed", "F G !obstacle_observed"
    assert check(WAITS, "F forward", *needs_both).assumptions == needs_both
    assert check(WAITS, "F forward", "G F TRUE", *needs_both).assumptions == needs_both


def test_a_counterexample_keeps_the_assumptions():
    result = check(WAITS, "F forward", "G F !people_observed")
    assert result.verdict is Verdict.FAIL
    example = result.counterexample
    labels = [step.labels for step in example.steps]
    assert holds(parse("G F !people_observed"), labels, example.loop_start)
    assert not holds(parse("F forward"), labels, example.loop_start)
    assert example.formula == "F forward"


def test_the_shipped_skill_needs_its_assumption():
    result = verify(BYPASS, BYPASS.plan_template)
    assert result.verdict is Verdict.PASS
    assert [s.assumptions for s in result.specs] == [(), (), (), ("G F !people_observed",)]


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("G F forward", "'forward', which is not an observation"),
        ("G(speed < 1)", r"compares numbers \(speed < 1\)"),
        ("G F !door_observed", "'door_observed', which is not decided by sensors"),
        ("speed < 1 -> stop", "compares numbers"),
    ],
)
def test_assumptions_about_anything_else_are_refused(text, why):
    with pytest.raises(SkillError, match=f"(?s){why}.*observations only"):
        check(PATIENT, "F forward", text)


def test_an_observation_that_depends_on_what_the_robot_does_is_refused():
    code = (
        DRIVE.labelling_code + "\ndef blocked():\n    return obstacle_observed() and speed() > 0\n"
    )
    skill = DRIVE.model_copy(update={"labelling_code": code})
    with pytest.raises(SkillError, match="'blocked', which is not decided by sensors"):
        verify(assuming("G F !blocked", skill=skill), PATIENT, specs=["F forward"])


def test_contradictory_assumptions_are_refused():
    with pytest.raises(SkillError, match=r"G people_observed and F !people_observed"):
        check(PATIENT, "G(speed < 0.5)", "G people_observed", "F !people_observed")


class Hesitant:
    """Decides everything but whether the assumption is possible."""

    name = "hesitant"

    def check(self, system, formulas, *, timeout=60.0, counterexamples=True):
        answers = AutoVerifier().check(
            system, formulas, timeout=timeout, counterexamples=counterexamples
        )
        impossible = parse("!(G F !people_observed)")
        return [
            Answer(Verdict.UNKNOWN, self.name, reason="time-out") if f == impossible else a
            for f, a in zip(formulas, answers, strict=True)
        ]


def test_an_assumption_that_may_be_impossible_proves_nothing():
    result = check(PATIENT, "F forward", "G F !people_observed", verifier=Hesitant())
    assert result.verdict is Verdict.UNKNOWN and "whether they can be true" in result.reason


def test_a_verifier_that_cannot_tell_whether_they_are_possible_gives_no_pass():
    result = check(PATIENT, "F forward", "G F !people_observed", verifier="lasso")
    assert result.verdict is Verdict.UNSUPPORTED
