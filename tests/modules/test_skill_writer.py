import pytest
from vaso_scripts import reply_for

from vaso.errors import FormulaError, SkillError
from vaso.modules.skill_writer import RefineSkill, SkillWriter, WriteSkill
from vaso.modules.wording import platform_text

PEOPLE_RULE = "G(people_observed -> X stop)"
GOOD_RULE = "G(!people_observed -> X forward)"
BAD_RULE = "G((!obstacle_observed | people_observed) -> X forward)"


def prompt(lm) -> str:
    return "\n".join(m["content"] for m in lm.history[-1]["messages"])


def write(**kw):
    return SkillWriter(**kw)("drive ahead", platform="jackal", global_rules=[PEOPLE_RULE])


def test_a_skill_is_read_back_and_checked(scripted):
    lm = scripted("skill_md", reply_for(PEOPLE_RULE, GOOD_RULE))
    found = write()
    assert found.skill.name == "drive"
    assert [r.text for r in found.skill.global_rules] == [PEOPLE_RULE]
    assert str(found.skill.local_rules[0]) == GOOD_RULE
    assert found.skill.platform == "jackal"
    assert found.feasibility.feasible is True
    assert "def velocity_publisher(linear, angular):" in prompt(lm)


def test_a_changed_global_contract_is_put_back(scripted):
    scripted("skill_md", reply_for("G(people_observed -> F stop)", GOOD_RULE))
    found = write()
    assert [r.text for r in found.skill.global_rules] == [PEOPLE_RULE]
    assert found.drafts[0].reinstated


def test_an_infeasible_rule_is_sent_back_with_the_paper_s_sentence(scripted):
    lm = scripted("skill_md", reply_for(PEOPLE_RULE, BAD_RULE), reply_for(PEOPLE_RULE, GOOD_RULE))
    found = write()
    assert found.feasibility.feasible is True
    assert "The local rule conflicts with the global specification" in prompt(lm)
    assert [bool(d.problem) for d in found.drafts] == [True, False]


def test_the_best_draft_is_kept_when_none_is_feasible(scripted):
    scripted("skill_md", *[reply_for(PEOPLE_RULE, BAD_RULE)] * 2)
    found = write(attempts=2)
    assert found.skill is not None
    assert found.feasibility.feasible is False
    assert len(found.drafts) == 2


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "empty"),
        ("I cannot do that.", "skill"),
        (reply_for(PEOPLE_RULE, "G(people_observed ->"), "never closed"),
        (reply_for(PEOPLE_RULE, GOOD_RULE).replace("while True:", "while True"), "Python"),
        (reply_for(PEOPLE_RULE, GOOD_RULE).replace(f"- {GOOD_RULE}", ""), "Local Contract"),
    ],
)
def test_an_unreadable_draft_is_sent_back_with_the_reason(scripted, text, why):
    lm = scripted("skill_md", text, reply_for(PEOPLE_RULE, GOOD_RULE))
    found = write()
    assert found.skill.name == "drive"
    assert found.drafts[0].skill is None
    assert why.lower() in found.drafts[0].problem.lower()
    assert found.drafts[0].problem.splitlines()[0] in prompt(lm)


def test_nothing_readable_at_all(scripted):
    scripted("skill_md", "no", "no")
    with pytest.raises(SkillError, match="2 attempts"):
        write(attempts=2)


def test_a_global_rule_must_parse(scripted):
    scripted("skill_md")
    with pytest.raises(FormulaError):
        SkillWriter()("drive", platform="jackal", global_rules=["G("])


def test_refine_keeps_what_is_not_a_parameter(scripted, skill):
    lm = scripted("skill_md", reply_for("G(speed < 0.1)", GOOD_RULE, name="other"))
    found = SkillWriter().refine(skill, "violates G(people_observed -> X stop)", "drive ahead")
    assert found.skill.name == "drive"
    assert found.skill.global_rules == skill.global_rules
    assert found.skill.platform == skill.platform
    assert "violates G(people_observed -> X stop)" in prompt(lm)
    assert skill.plan_template.strip() in prompt(lm)


def test_refine_never_loses_the_skill(scripted, skill):
    scripted("skill_md", "no", "no", "no")
    found = SkillWriter().refine(skill, "wrong", "drive ahead")
    assert found.skill is skill
    assert len(found.drafts) == 3


def test_the_signature_asks_for_what_the_paper_asks():
    text = WriteSkill.instructions
    for part in ("Global Contract", "Local Contract", "Semantic Contract", "Plan Template"):
        assert part in text
    assert "skill_md_before" in RefineSkill.input_fields


@pytest.mark.parametrize("name", ["jackal", "px4"])
def test_platforms_are_described_from_their_objects(name):
    from vaso.platforms import get_platform

    text = platform_text(name)
    platform = get_platform(name)
    for item in (*platform.commands, *platform.sensors, *platform.propositions):
        assert item.name in text
