import pytest
from fakes import SKILL
from hypothesis import given
from hypothesis import strategies as st

from vaso.errors import OptimizerError
from vaso.optimizers.parameters import MAX_CHARACTERS, Parameters, check_python, check_rule
from vaso.skill import Rule


def test_is_a_mapping_of_the_skills_texts():
    params = Parameters(SKILL)
    assert dict(params) == dict(SKILL.parameters) and params.skill == SKILL
    assert params.problems() == {} and params.trainable == ("labelling_code", "plan_template")


def test_replace_diff_and_key():
    before = Parameters(SKILL)
    after = before.replace({"plan_template": "score = 0.9\n"})
    assert before.changed(after) == ("plan_template",) and before.key != after.key
    assert "-score = 0.5" in before.diff(after) and "+score = 0.9" in before.diff(after)
    assert after.replace({"plan_template": SKILL.plan_template}).key == before.key


def test_surrounding_newlines_are_no_change():
    params = Parameters(SKILL)
    assert params.replace({"plan_template": f"\n{SKILL.plan_template}\n\n"}).key == params.key


def test_an_unchanged_rule_keeps_its_note():
    skill = SKILL.model_copy(
        update={"local_rules": (Rule(text="F forward", role="local", note="rule 4"),)}
    )
    params = Parameters(skill).replace({"plan_template": "x = 2"})
    assert params.skill.local_rules[0].note == "rule 4"


@pytest.mark.parametrize("name", ["global_rules", "name", "assumptions"])
def test_nothing_else_can_be_optimized(name):
    with pytest.raises(OptimizerError, match=name):
        Parameters(SKILL, trainable=[name])
    with pytest.raises(OptimizerError, match=name):
        Parameters(SKILL).replace({name: "x"})


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("while True\n    stop()", "line 1"),
        ("x = 1\nif a\n    or b: pass", "line 2"),
        ("", "empty"),
        (" \n\t\n", "empty"),
        ("x = '\0'", "not Python"),
        ("(" * 5000 + ")" * 5000, "not Python"),
        ("#" * (MAX_CHARACTERS + 1), "longer"),
    ],
)
def test_python_that_is_not(text, problem):
    assert problem in (check_python(text) or "")


def test_rules():
    assert check_rule("G(a -> X b)\n\nF c") is None and check_rule("") is None
    assert "line 2" in (check_rule("G a\nG(a ->") or "")


@given(st.text())
def test_gates_never_raise(text):
    check_python(text)
    check_rule(text)
    params = Parameters(SKILL).replace({"plan_template": text, "labelling_code": text})
    assert params.skill.global_rules == SKILL.global_rules
