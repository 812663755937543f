"""Skills as objects."""

import pytest
from pydantic import ValidationError

from vaso.errors import SkillError
from vaso.skill import Rule, Skill
from vaso.skill_file import load_skill


def drive() -> Skill:
    return load_skill("drive")


class TestRule:
    def test_it_must_be_a_formula(self) -> None:
        with pytest.raises(ValidationError, match="never closed"):
            Rule(text="G(a")

    def test_text_and_formula(self) -> None:
        rule = Rule(text="G(people observed → X ¬ forward)")
        assert rule.text == "G(people observed → X ¬ forward)"
        assert str(rule) == "G(people_observed -> X !forward)"

    def test_warnings(self) -> None:
        assert Rule(text="F !a & !b -> F !c").parsed.warnings


class TestEquality:
    def test_where_a_skill_comes_from_does_not_count(self) -> None:
        moved = drive().model_copy(update={"source": None, "template_line": 99})
        assert moved == drive() and hash(moved) == hash(drive())

    def test_content_counts(self) -> None:
        assert drive() != drive().model_copy(update={"plan_template": "stop()"})
        assert drive() != drive().model_copy(update={"metadata": {"license": "MIT"}})
        assert drive() != "drive"


class TestParameters:
    def test_names(self) -> None:
        skill = drive()
        assert list(skill.parameters) == ["local_rule", "labelling_code", "plan_template"]
        assert skill.parameters["plan_template"] == skill.plan_template

    def test_replacing(self) -> None:
        skill = drive().with_parameters({"plan_template": "stop()\n", "local_rule": "F a\n\nF b"})
        assert skill.plan_template == "stop()"
        assert [(r.text, r.role) for r in skill.local_rules] == [("F a", "local"), ("F b", "local")]
        assert skill.global_rules == drive().global_rules

    def test_messages_no_longer_point_into_the_file(self) -> None:
        skill = drive().with_parameters({"plan_template": "stop()"})
        assert (skill.source, skill.labelling_line, skill.template_line) == (None, 1, 1)

    def test_the_same_texts_change_nothing(self) -> None:
        skill = drive()
        same = skill.with_parameters(skill.parameters)
        assert same == skill and same.source == skill.source
        assert [r.note for r in same.local_rules] == ["rule 4"]

    def test_unknown_name(self) -> None:
        with pytest.raises(SkillError, match="not a parameter"):
            drive().with_parameters({"global_rules": "TRUE"})  # type: ignore[dict-item]

    def test_bad_rule(self) -> None:
        with pytest.raises(SkillError) as caught:
            drive().with_parameters({"local_rule": "F a\nF(b"})
        assert "never closed" in caught.value.message and "^" in caught.value.message
