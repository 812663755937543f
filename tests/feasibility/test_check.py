import json

import pytest

from vaso import load_skill, shipped_skills
from vaso.errors import PlatformError, SkillError
from vaso.feasibility import check
from vaso.ltl import holds, parse
from vaso.skill import Rule, Skill

STOP = "G(person observed -> X stop)"
BLOCKED = "G(obstacle_observed -> X !forward)"
SPEED = "G(speed < 0.5)"
ORIGINAL = "G(!obstacle observed | person observed -> X forward)"
REGENERATED = "G(!(obstacle observed | person observed) -> X forward)"


def skill(local: list[str], general: list[str], **more: object) -> Skill:
    return Skill(
        name="drive",
        local_rules=tuple(Rule(text=t, role="local") for t in local),
        global_rules=tuple(Rule(text=t) for t in general),
        assumptions=tuple(Rule(text=t, role="assumption") for t in more.pop("assumptions", ())),
        **more,
    )


@pytest.mark.parametrize("general", [[STOP], [STOP, BLOCKED, SPEED], [SPEED, BLOCKED, STOP]])
def test_the_papers_example_is_infeasible_with_its_two_formulas(general: list[str]) -> None:
    result = check(skill([ORIGINAL], general))
    assert result.feasible is False and not result
    assert result.satisfiable.sat is True  # the paper's own check lets it pass
    assert result.exercisable is False
    assert set(result.core) == {str(parse(STOP)), str(parse(ORIGINAL))}
    assert result.conflict.trigger == "person_observed"
    assert result.feedback == (
        "The local rule conflicts with the global specification G(person_observed -> X stop)."
    )
    assert "breaks it in step" in result.conflict.attempt


@pytest.mark.parametrize("general", [[STOP], [STOP, BLOCKED, SPEED]])
def test_the_papers_regenerated_rule_is_feasible(general: list[str]) -> None:
    result = check(skill([REGENERATED], general))
    assert result and result.feedback == "" and result.core == ()
    triggers = {t.trigger for t in result.triggers}
    assert {"person_observed", "!(obstacle_observed | person_observed)"} <= triggers
    witness = result.witness
    for text in [REGENERATED, *general, *(f"F({t})" for t in triggers)]:
        assert holds(parse(text), witness.steps, witness.loop_start)
    assert not any(s["forward"] and s["stop"] for s in witness.steps)


def test_the_global_rule_may_be_written_without_an_implication() -> None:
    result = check(skill([ORIGINAL], ["G(!person_observed | X stop)"]))
    assert result.feasible is False and len(result.core) == 2


def test_several_local_and_global_rules_are_named() -> None:
    result = check(skill(["F backward", "G !stop"], [SPEED, "F stop", STOP]))
    assert result.satisfiable.sat is False
    assert result.satisfiable.core == ("F stop", "G !stop")
    assert (
        result.feedback == "The local rule G !stop conflicts with the global specification F stop."
    )
    assert not result.conflict.exclusions
    three = check(skill(["G(p -> q)"], ["F p", "G !q"]))
    assert three.feedback == (
        "The local rule conflicts with the global specifications F p and G !q."
    )


def test_global_rules_that_conflict_do_not_blame_the_local_rule() -> None:
    result = check(skill(["G(person_observed -> X stop)"], ["G forward", "F stop"]))
    assert result.core == ("G forward", "F stop")
    assert result.feedback == (
        "The global specifications G forward and F stop conflict with each other."
    )
    assert result.conflict.exclusions


def test_a_rule_that_contradicts_itself() -> None:
    result = check(skill(["G(person_observed -> X(forward & stop))"], [SPEED]))
    assert result.satisfiable.sat is True
    assert result.feedback.startswith(
        "The local rule G(person_observed -> X(forward & stop)) cannot"
    )


def test_a_trigger_that_can_never_occur_is_a_conflict() -> None:
    result = check(skill(["G(forward & stop -> X backward)"], [SPEED]))
    assert result.feasible is False
    assert result.core == ("G(forward & stop -> X backward)",)


def test_the_paper_rules_of_both_platforms_are_feasible() -> None:
    bypass = skill(
        ["F(!people_observed & !obstacle_observed) -> F !stop",
         "F(obstacle_observed) -> F(turn_left | turn_right)"],
        ["G(people_observed -> X stop)", BLOCKED, SPEED],
    )  # fmt: skip
    result = check(bypass)
    assert result.satisfiable and result.exercisable
    # Obstacles may show only while people are in view, so no plan keeps them (tests/synthesis).
    assert result.realizable is False and result.hopeless and result.feasible
    square = skill(
        ["F(linear_velocity == 0 & altitude == 0)",
         "G(altitude == 0 -> linear_velocity == 0)",
         "F(linear_velocity > 0)"],
        ["G(max_altitude < 10)", "G(velocity_change <= 1)", "G(linear_velocity <= 1)"],
        platform="px4",
    )  # fmt: skip
    assert check(square)


@pytest.mark.parametrize("version", ["initial", "verified"])
@pytest.mark.parametrize("name", shipped_skills())
def test_the_shipped_skills_are_feasible(name: str, version: str) -> None:
    assert check(load_skill(name, version=version))


def test_assumptions_restrict_the_behaviours_that_count() -> None:
    assumed = skill(
        ["F stop"], ["G forward | G !person_observed"], assumptions=["G F person_observed"]
    )
    result = check(assumed)
    assert result.feasible is False
    assert result.feedback == (
        "The local rule conflicts with the global specification G forward | G !person_observed"
        " under the assumption G F person_observed."
    )
    fine = check(skill(["F forward"], [], assumptions=["G F !person_observed"]))
    assert fine and fine.assumptions == ("G F !person_observed",)


def test_assumptions_must_be_satisfiable() -> None:
    result = check(skill(["F stop"], [], assumptions=["G person_observed", "F !person_observed"]))
    assert result.feasible is False
    assert result.feedback == (
        "The assumptions G person_observed and F !person_observed conflict with each other."
    )


@pytest.mark.parametrize("text", ["G F forward", "G(speed < 1)", "G F pick"])
def test_assumptions_speak_about_the_world_only(text: str) -> None:
    code = "def pick() -> None:\n    pass\n\ndef door_open() -> bool:\n    return True\n"
    with pytest.raises(SkillError, match="which the robot decides"):
        check(skill(["F stop"], [], assumptions=[text], labelling_code=code))
    assert check(skill(["F stop"], [], assumptions=["G F door_open"], labelling_code=code))


def test_observations_of_the_labelling_code_count() -> None:
    code = "def door_open():\n    return yolo_listener('door')\n"
    rules = ["G(!obstacle_observed | door_open -> X forward)"], ["G(!door_open | X stop)"]
    assert check(skill(*rules, labelling_code=code)).feasible is False
    assert check(skill(*rules)).feasible is True  # who decides about door_open is not known


def test_without_time_nothing_is_feasible() -> None:
    result = check(skill([REGENERATED], [STOP]), timeout=0.0)
    assert result.feasible is None and not result
    assert "time" in result.reason and result.conflict is None


def test_a_skill_without_rules_is_feasible() -> None:
    assert check(skill([], []))


def test_an_unknown_platform_is_reported() -> None:
    with pytest.raises(PlatformError):
        check(skill([REGENERATED], [STOP], platform="submarine"))


def test_plain_data_and_text() -> None:
    result = check(skill([ORIGINAL], [STOP]))
    data = json.loads(json.dumps(result.to_json()))
    assert data["feasible"] is False and data["core"] == list(result.core)
    unchecked = "not asked: no behaviour keeps the rules"
    assert data["realizable"] == {"value": None, "reason": unchecked}
    assert "infeasible" in result.summary() and result.feedback in result.summary()
    assert "not decided" in check(skill([ORIGINAL], [STOP]), timeout=0.0).summary()
