"""Verifying plans end to end: the paper's plans, bad input, incomplete exploration."""

import json

import pytest

from vaso import Plan, load_skill, verify
from vaso.errors import FormulaError, PlanError, PlatformError, SkillError, VerifierError
from vaso.ltl import parse
from vaso.plan.explore import Budget
from vaso.skill import Rule
from vaso.verdict import Verdict

DRIVE, SQUARE = load_skill("drive"), load_skill("fly-in-square-shape-traj")
INITIAL = {n: load_skill(n, version="initial") for n in (DRIVE.name, SQUARE.name)}
WATCH = "while True:\n    stop() if people_observed() or obstacle_observed() else forward()\n"
ENGINES = ["auto", "pynusmv", "nusmv"]


def failed(result) -> list[str]:
    return [s.formula for s in result.specs if s.verdict is Verdict.FAIL]


# --- the paper's plans -------------------------------------------------------------------------


@pytest.mark.parametrize("verifier", ENGINES)
def test_the_initial_drive_template_fails_on_rule_four_only(verifier):
    skill = INITIAL["drive"]
    result = verify(skill, skill.plan_template, verifier=verifier)
    assert failed(result) == ["F(!people_observed & !obstacle_observed) -> F !stop"]
    assert result.verdict is Verdict.FAIL and not result and result.safety == 0.75
    example = result.failures[0].counterexample
    assert [s.line for s in example.steps] == [None, 6, 6]
    assert all(s.labels["stop"] for s in example.steps)
    assert (
        example.steps[0].labels["people_observed"] or example.steps[0].labels["obstacle_observed"]
    )
    assert example.decided_at is None


@pytest.mark.parametrize("verifier", ENGINES)
def test_the_initial_square_climbs_to_ten_metres(verifier):
    skill = INITIAL["fly-in-square-shape-traj"]
    result = verify(skill, skill.plan_template, verifier=verifier)
    assert "G(altitude < 10)" in failed(result)
    example = next(s for s in result.specs if s.formula == "G(altitude < 10)").counterexample
    assert example.decided_at == 10
    assert example.steps[10].labels["altitude"] == 10.0


@pytest.mark.parametrize("name", ["drive", "find-object", "fly-in-square-shape-traj"])
def test_the_shipped_templates_pass(name):
    skill = load_skill(name)
    result = verify(name, skill.plan_template)
    assert result and result.safety == 1.0 and result.problem is None


def test_reading_people_in_every_period_keeps_rule_one():
    plan = "while True:\n    stop() if people_observed() else forward()\n"
    spec = verify(DRIVE, plan, specs=["G(people_observed -> X stop)"]).specs[-1]
    assert spec.verdict is Verdict.PASS and spec.vacuous is None and spec.role == "extra"


def test_two_commands_after_one_look_break_rule_one():
    plan = "if people_observed():\n    stop()\nelse:\n    forward()\nturn_left()\n"
    assert "G(people_observed -> X stop)" in failed(verify(DRIVE, plan))


# --- what a result says ------------------------------------------------------------------------


def test_every_rule_gets_its_english_role_and_engine():
    result = verify(DRIVE, WATCH, specs=["F !people_observed & !obstacle_observed -> F !stop"])
    assert [s.role for s in result.specs] == ["global", "global", "global", "local", "extra"]
    assert result.specs[0].english == "whenever people are observed, the next command is stop"
    assert [s.engine for s in result.specs[:3]] == ["pynusmv", "pynusmv", "lasso"]
    assert result.specs[-1].warnings and not result.specs[0].warnings
    assert result.states == len(result.system.states) and result.plan == WATCH


def test_the_result_is_json():
    skill = INITIAL["drive"]
    data = json.loads(json.dumps(verify(skill, skill.plan_template).to_json()))
    assert data["verdict"] == "fail" and data["specs"][3]["counterexample"]["steps"][1]["line"] == 6


def test_specs_may_be_formulas_and_rules():
    extra = [parse("G(speed < 0.4)"), Rule(text="G(speed < 0.2)", role="local")]
    last = verify(DRIVE, WATCH, specs=extra).specs[-2:]
    assert [(s.spec, s.role, s.verdict.value) for s in last] == [
        ("G(speed < 0.4)", "extra", "pass"), ("G(speed < 0.2)", "local", "fail"),
    ]  # fmt: skip


def test_counterexamples_can_be_left_out():
    skill = INITIAL["drive"]
    result = verify(skill, skill.plan_template, counterexamples=False)
    assert len(failed(result)) == 1 and result.failures[0].counterexample is None


def test_a_plan_comes_as_text_as_a_plan_or_from_a_file(tmp_path):
    file = tmp_path / "plan.py"
    file.write_text(WATCH)
    for plan in (WATCH, Plan(source=WATCH), file):
        assert verify(DRIVE, plan)


def test_the_lasso_verifier_alone_decides_what_it_can():
    result = verify(DRIVE, WATCH, verifier="lasso")
    assert [s.verdict.value for s in result.specs] == ["unsupported"] * 2 + ["pass", "unsupported"]
    assert result.verdict is Verdict.UNSUPPORTED


def test_no_time_gives_no_pass():
    result = verify(DRIVE, WATCH, timeout=0.0, verifier="pynusmv")
    assert {s.verdict for s in result.specs} == {Verdict.UNKNOWN} == {result.verdict}
    assert all(s.reason for s in result.specs)


# --- bad input ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("plan", "line", "kind"),
    [
        ("forward()\nif people_observed()\n    or obstacle_observed():\n    stop()\n", 2, "input"),
        ("forward()\nfly_away()\n", 2, "input"),
        ("velocity_publisher(0.1, 0.2, 0.3)\n", 1, "input"),
        ("forward()\nopen('/etc/passwd')\n", 2, "unsupported"),
        ("import os\nos.system('true')\n", None, None),
        ("", None, None),
    ],
)
def test_bad_plans_are_reported_with_their_line(plan, line, kind):
    result = verify(DRIVE, plan)
    assert not result or plan == ""
    if kind is not None:
        assert result.problem.kind == kind and result.problem.line == line
        assert {s.verdict for s in result.specs} == {Verdict.UNSUPPORTED}
        assert all(s.reason == result.problem.message for s in result.specs)
        assert result.verdict is Verdict.UNSUPPORTED and result.safety == 0.0


def test_labelling_code_that_does_not_run_is_reported():
    broken = DRIVE.model_copy(update={"labelling_code": "def people_observed():\n    return 1 +\n"})
    result = verify(broken, WATCH)
    assert result.problem.kind == "input" and result.problem.line is None
    assert {s.verdict for s in result.specs} == {Verdict.UNSUPPORTED}


def test_a_proposition_that_does_not_exist_is_named():
    result = verify(DRIVE, WATCH, specs=["G(door_observed -> X stop)", "G(height < 3)", "G speed"])
    reasons = [s.reason for s in result.specs[-3:]]
    assert [s.verdict.value for s in result.specs] == ["pass"] * 4 + ["unsupported"] * 3
    assert "no proposition 'door_observed'" in reasons[0] and "obstacle_observed" in reasons[0]
    assert "no proposition 'height'" in reasons[1]
    assert "compare it with a number" in reasons[2]


def test_a_spec_that_does_not_parse_raises():
    with pytest.raises(FormulaError):
        verify(DRIVE, WATCH, specs=["G(people_observed -> )"])


def test_things_that_are_not_there_raise(tmp_path):
    with pytest.raises(PlanError, match="cannot be read"):
        verify(DRIVE, tmp_path / "plan.py")
    with pytest.raises(SkillError):
        verify("no-such-skill", WATCH)
    with pytest.raises(PlatformError):
        verify(DRIVE, WATCH, platform="submarine")
    with pytest.raises(VerifierError):
        verify(DRIVE, WATCH, verifier="oracle")


def test_nothing_to_check_is_not_a_pass():
    empty = DRIVE.model_copy(update={"global_rules": (), "local_rules": ()})
    assert verify(empty, WATCH).verdict is Verdict.UNKNOWN


# --- incomplete exploration --------------------------------------------------------------------

COUNTS = "n = 0\nwhile True:\n    n += 1\n    forward()\n    if n == 1_000_000:\n        stop()\n"


def test_a_plan_that_is_too_long_gets_the_verdicts_that_its_beginning_decides():
    result = verify(
        DRIVE,
        COUNTS,
        specs=["F forward", "G(speed < 0.2)", "X X forward"],
        budget=Budget(states=20),
    )
    found = [s.verdict.value for s in result.specs]
    assert found == ["fail", "fail", "unknown", "pass", "pass", "fail", "pass"]
    assert "explored up to step" in result.specs[2].reason and "20 states" in result.specs[2].reason
    assert result.problem.kind == "unknown" and result.verdict is Verdict.FAIL
    example = result.specs[-2].counterexample
    assert example.decided_at == 1


def test_an_unsupported_construct_is_not_a_pass():
    plan = "forward()\nstop()\n'a'.no_such_method()\n"
    result = verify(DRIVE, plan, specs=["F forward", "G(speed < 0.5)"])
    assert [s.verdict.value for s in result.specs[-2:]] == ["pass", "unsupported"]
    assert result.problem.kind == "unsupported" and result.problem.line == 3


def test_a_bound_that_no_rule_depends_on_is_a_warning():
    empty = DRIVE.model_copy(update={"global_rules": (), "local_rules": ()})
    result = verify(empty, COUNTS, specs=["F forward"], budget=Budget(states=20))
    assert result and result.problem is None and "explored up to step" in result.warnings[-1]
