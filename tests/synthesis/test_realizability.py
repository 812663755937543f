import json
import random

import pytest

import vaso
from tests.synthesis.defeating import defeats
from tests.synthesis.formulas import contract
from vaso import Verdict, load_skill, realizability, verify
from vaso.errors import MissingDependencyError, SkillError
from vaso.feasibility import check
from vaso.synthesis import solver as solving

RULE_5 = "F(obstacle_observed) -> F(turn_left | turn_right)"
REFINED = "F(obstacle_observed & !people_observed) -> F(turn_left | turn_right)"
CALLS = ("forward()", "backward()", "stop()", "turn_left()", "turn_right()")


def lines(text: str) -> list[str]:
    return [line for line in text.splitlines() if line.strip()]


# --- what can be kept --------------------------------------------------------------------------


@pytest.fixture(scope="module")
def shipped():
    names = ("drive", "bypass-object", "find-object")
    return {name: realizability(name, timeout=60) for name in names}


def test_shipped_contracts_are_realizable_with_a_verified_plan(shipped) -> None:
    for name, result in shipped.items():
        assert result and result.origin == "synthesized" and result.reason == ""
        assert verify(load_skill(name), result.plan).verdict is Verdict.PASS
        assert len(lines(result.plan)) <= 12
        assert all(s.vacuous is None for s in result.verification.specs if "observed" in s.spec)


def test_the_plan_for_drive_is_what_a_person_would_write(shipped) -> None:
    assert lines(shipped["drive"].plan) == [
        "while True:",
        "    if people_observed() or obstacle_observed():",
        "        stop()",
        "    else:",
        "        forward()",
    ]


def test_a_plan_remembers_what_it_must(shipped) -> None:
    seen = shipped["find-object"].plan
    assert "target_seen = True" in seen and "target_seen = False" in seen.splitlines()[0]
    assert shipped["bypass-object"].plan.count("obstacle_pending = False") == 2


def test_a_template_answers_where_the_game_cannot() -> None:
    skill = load_skill("find-object")
    numbers = "G(speed <= 0.25)"  # no call of the skill but stop() and the turns is that slow
    slow = skill.model_copy(
        update={
            "global_rules": (*skill.global_rules, vaso.Rule(text=numbers)),
            "local_rules": (vaso.Rule(text="G F(speed > 0.1)", role="local"),),
            "plan_template": "while True:\n    set_velocity(0.2, 0.0)\n",
        }
    )
    result = realizability(slow, timeout=60)
    assert result.realizable is None and "calls only" in result.reason
    free = slow.model_copy(update={"global_rules": (vaso.Rule(text=numbers),)})
    result = realizability(free, timeout=60)
    assert result and result.origin == "template" and result.plan == free.plan_template


def test_an_assumption_makes_the_difference() -> None:
    local = ["G F forward"]
    assert realizability(contract(local), timeout=60).realizable is False
    quiet = "G F(!people_observed & !obstacle_observed)"
    result = realizability(contract(local, assumptions=[quiet]), timeout=60)
    assert result and result.assumptions == (quiet,)


def test_plans_with_more_to_remember_than_a_flag_are_written_as_states() -> None:
    skill = contract(
        ["F(people_observed & X people_observed) -> F backward",
         "G(backward -> Y people_observed)", "F forward"],
        [],
    )  # fmt: skip
    result = realizability(skill, timeout=60)
    assert "state = 1" in result.plan and verify(skill, result.plan)


def test_past_bounded_and_conditional_rules() -> None:
    for rules in (
        ["G(turn_left -> O obstacle_observed)", "G(obstacle_observed -> F turn_left)"],
        ["G(obstacle_observed -> X X turn_left)", "F forward"],
        ["G(people_observed -> X (stop W !people_observed))"],
        ["F people_observed -> F G stop"],
    ):
        skill = contract(rules, [])
        result = realizability(skill, timeout=60)
        assert result and verify(skill, result.plan).verdict is Verdict.PASS, rules


# --- what cannot -------------------------------------------------------------------------------


def test_rule_5_is_not_realizable_and_is_refined_as_on_the_design_page() -> None:
    result = realizability(contract([RULE_5]), timeout=60)
    assert result.realizable is False and not result and result.plan is None
    assert [r.text for r in result.core] == ["G(people_observed -> X stop)", RULE_5]
    assert result.minimal and result.refinement.after == REFINED
    assert result.remedies == ("G F !people_observed",)
    assert "No plan can keep the local rule" in result.feedback and REFINED in result.feedback
    assert realizability(contract([REFINED]), timeout=60)
    assert realizability(contract([RULE_5], assumptions=result.remedies), timeout=60)


UNREALIZABLE = [
    ([RULE_5], None),
    (["G F forward"], None),
    (["G(obstacle_observed -> X turn_left)"], None),
    (["F(!stop)", "G(people_observed -> stop)"], []),
    (["X G(people_observed <-> stop)"], []),
    (["X G(people_observed -> stop)", "X G(stop -> people_observed | obstacle_observed)"], []),
    pytest.param(
        ["G(obstacle_observed -> F turn_left)", "F G(people_observed -> X stop)"],
        None,
        marks=pytest.mark.slow,
    ),
]


@pytest.mark.parametrize(("local", "general"), UNREALIZABLE)
def test_the_sensors_defeat_every_plan(local: list[str], general: list[str] | None) -> None:
    skill = contract(local, general)
    result = realizability(skill, timeout=60, refine=False)
    assert result.realizable is False and result.minimal and result.counterplay is not None
    broken = skill.model_copy(update={"global_rules": result.core, "local_rules": ()})
    for plan in plans(random.Random(0), 12):
        assert defeats(result.counterplay, broken, plan), plan


def plans(rng: random.Random, count: int) -> list[str]:
    """Decision lists over the sensors, with a flag, and straight plans."""
    found = []
    for _ in range(count):
        a, b, c, d = (rng.choice(CALLS) for _ in range(4))
        one, two = rng.sample(["people_observed()", "obstacle_observed()"], 2)
        found.append(
            rng.choice(
                [
                    f"while True:\n    if {one}:\n        {a}\n    elif {two}:\n        {b}\n"
                    f"    else:\n        {c}\n",
                    f"{a}\n{b}\nwhile {one}:\n    {c}\n{d}\n",
                    f"seen = False\nwhile True:\n    if {one}:\n        seen = not seen\n"
                    f"    if seen and not {two}:\n        {a}\n    else:\n        {b}\n",
                ]
            )
        )
    return found


def test_no_part_of_a_core_is_unrealizable() -> None:
    skill = contract(["F forward", "F backward"], ["G(people_observed -> X stop)", "G F stop"])
    core = realizability(skill, timeout=60, refine=False).core
    assert len(core) == 2
    for rule in core:
        rest = contract([], [r.text for r in core if r is not rule])
        assert realizability(rest, timeout=60).realizable is True


def test_a_refined_rule_still_asks_for_something() -> None:
    skill = contract(["G(obstacle_observed -> X turn_left)"])
    refined = realizability(skill, timeout=60).refinement
    assert refined.after == "G(obstacle_observed & !people_observed -> X turn_left)"
    edit = refined.edit("F forward\nG(obstacle_observed -> X turn_left)")
    assert edit.after.splitlines() == ["F forward", refined.after]
    # Nothing is left of a trigger that the other rules never allow.
    hopeless = contract(["F(people_observed) -> F forward"], ["G !forward"])
    assert realizability(hopeless, timeout=60).refinement is None


def test_the_gradient_is_on_the_local_rule() -> None:
    result = realizability(contract([RULE_5]), timeout=60)
    gradient = result.gradient(RULE_5)
    assert not gradient.passed and gradient.repair.parameter == "local_rule"
    assert gradient.repair.after == REFINED and "possible: stop()" in gradient.trace
    assert str(result.gradient(RULE_5, "verdict")) == result.feedback


# --- what is not known -------------------------------------------------------------------------


def test_rules_outside_gr1_are_named_and_never_decide_wrongly() -> None:
    result = realizability(contract(["G F people_observed -> G F forward"], []), timeout=60)
    assert [o.rule for o in result.outside] == ["G F people_observed -> G F forward"]
    assert result and verify(contract(["G F people_observed -> G F forward"], []), result.plan)
    # Unrealizable without the rule outside: so with it.
    result = realizability(contract(["G F forward", "F G stop"]), timeout=60)
    assert result.realizable is False
    # Here a plan exists, but it must bring about what the game only knows in a weaker form.
    result = realizability(
        contract(["F G(people_observed -> X stop)", "F G !stop"], []), timeout=60
    )
    assert result.realizable is not True


def test_assumptions_outside_gr1_are_not_used_against_the_robot() -> None:
    result = realizability(
        contract(["F G forward"], assumptions=["F G(!people_observed & !obstacle_observed)"]),
        timeout=60,
    )
    assert result.realizable is None and result.outside


def test_unknown_propositions_are_nobodys() -> None:
    result = realizability(contract(["G(door_open -> X stop)"]), timeout=60)
    assert result.realizable is None and "door_open" in result.reason


def test_rules_alone_are_decided_over_their_propositions() -> None:
    rules = ["G(people_observed -> X stop)", "F(!people_observed) -> F forward"]
    result = realizability(contract(rules, [], labelling_code=""), timeout=60)
    assert (
        result.realizable is True and result.plan is None and "no labelling code" in result.reason
    )
    result = realizability(contract([RULE_5], labelling_code=""), timeout=60)
    assert result.realizable is False and result.counterplay is not None
    # Both names are one detector on this robot.
    same = ["G(people_observed -> X stop)", "G(person_observed -> X forward)"]
    assert realizability(contract(same, [], labelling_code=""), timeout=60).realizable is False


def test_sensors_that_a_plan_can_switch_off_prove_nothing() -> None:
    code = load_skill("drive").labelling_code.replace(
        'return yolo_listener("people")', 'return LOOKING and yolo_listener("people")'
    )
    code += "\nLOOKING = True\n\ndef look(on):\n    global LOOKING\n    LOOKING = on\n"
    result = realizability(contract([RULE_5], labelling_code=code), timeout=60)
    assert result.realizable is None and "people_observed" in result.reason


def test_labels_that_remember_are_not_trusted_to_the_game() -> None:
    code = load_skill("drive").labelling_code + (
        "\nCOUNT = 0\n\ndef tired() -> float:\n    return float(COUNT)\n\n"
        "def hop() -> None:\n    global COUNT\n    COUNT = min(COUNT + 1, 3)\n"
        "    velocity_publisher(linear=0.1, angular=0.0)\n"
    )
    result = realizability(contract(["G(tired < 2)"], [], labelling_code=code), timeout=60)
    assert result.realizable is None and "'tired' depends on more" in result.reason


def test_assumptions_that_no_sensors_can_keep() -> None:
    skill = contract(["F forward"], assumptions=["G(people_observed <-> !person_observed)"])
    skill = skill.model_copy(
        update={"labelling_code": skill.labelling_code
                + '\n\ndef person_observed() -> bool:\n    return yolo_listener("people")\n'}
    )  # fmt: skip
    result = realizability(skill, timeout=60)
    assert result.realizable is None and "no sensors" in result.reason


def test_time_is_kept() -> None:
    rules = [f"G(people_observed -> {'X ' * n}turn_left)" for n in range(6, 12)]
    assert realizability(contract(rules), timeout=0.3).realizable is not True
    assert realizability(contract([RULE_5]), timeout=0.0).reason == "out of time"


def test_bad_input_is_refused() -> None:
    with pytest.raises(SkillError, match="robot decides"):
        realizability(contract(["F forward"], assumptions=["G F stop"]))
    empty = contract([], [])
    assert realizability(empty).realizable is None


def test_without_the_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solving, "is_installed", lambda: False)
    with pytest.raises(MissingDependencyError, match="omega"):
        realizability("drive")


# --- as level (c) of a check -------------------------------------------------------------------


def test_check_has_level_c() -> None:
    result = check(contract([RULE_5]), timeout=60)
    assert result.satisfiable and result.exercisable and result.realizable is False
    assert result.feasible and result.hopeless and result.verdict == "unrealizable"
    assert result.feedback.startswith("No plan can keep")
    data = json.loads(json.dumps(result.to_json()))
    assert data["realizable"]["value"] is False
    assert data["realizable"]["counterplay"]["fixed"] is True
    assert data["realizable"]["refinement"]["after"] == REFINED
    assert "(c) realizable: no" in result.summary() and REFINED in result.summary()
    unasked = check(contract([RULE_5]), timeout=60, realizable=False)
    assert unasked.feasible is True and unasked.realizable is None


def test_check_says_how_to_get_level_c(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vaso.synthesis.is_installed", lambda: False)
    result = check(contract(["F forward"]), timeout=60)
    assert result.feasible is True and "make everything" in result.unchecked
    with pytest.raises(MissingDependencyError):
        monkeypatch.setattr(solving, "is_installed", lambda: False)
        check(contract(["F forward"]), timeout=60, realizable=True)


def test_a_rule_that_no_plan_can_keep_is_refined_by_repair() -> None:
    skill = load_skill("bypass-object", version="initial").model_copy(update={"assumptions": ()})
    result = vaso.optimize(skill, ["Travel 5 m."], optimizer="repair")
    assert result.verified and result.skill.local_rules[0].text == REFINED
