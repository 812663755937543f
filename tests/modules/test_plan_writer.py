import dspy
import pytest
from vaso_scripts import BLIND, TEMPLATE, field

from vaso.errors import SkillError
from vaso.modules import PlanWriter
from vaso.modules.plan_writer import template_of, with_template

PROSE = "Write a plan. Be careful: people (and dogs) walk about."


def test_the_template_is_part_of_the_instructions(skill):
    writer = PlanWriter(skill)
    assert f"```python\n{TEMPLATE}```" in writer.signature.instructions
    assert writer.skill == skill
    assert list(writer.signature.input_fields) == [
        "task",
        "rules",
        "apis",
        "previous_plan",
        "feedback",
    ]


@pytest.mark.parametrize(
    "instructions",
    [
        f"{PROSE}\n\n```python\n{BLIND}```",
        f"{PROSE}\n```\n{BLIND}```\nThat is all.",
        f"{PROSE}\n````python\n{BLIND}````",
        f"For example `stop()`:\n```python\nstop()\n```\nBut:\n```py\n{BLIND}```",
        f"```bash\nrm -rf {'x' * 99}\n```\n```python\n{BLIND}```",
    ],
)
def test_the_template_is_read_from_what_an_optimizer_writes(skill, instructions):
    assert template_of(instructions) == BLIND.strip()
    writer = PlanWriter(skill)
    writer.signature = writer.signature.with_instructions(instructions)
    assert writer.skill.plan_template == BLIND.strip()
    assert writer.skill.rules == skill.rules


def test_bare_code_as_instructions_is_the_template(skill):
    writer = PlanWriter(skill)
    writer.signature = writer.signature.with_instructions(BLIND)
    assert writer.skill.plan_template == BLIND.strip()
    assert writer.signature.instructions.startswith("Write a Python program")
    assert PlanWriter(skill).load_state(writer.dump_state()).skill == writer.skill


@pytest.mark.parametrize("instructions", [PROSE, "stop", "while True:", "x = 1", "(" * 300])
def test_instructions_without_a_template(skill, instructions):
    writer = PlanWriter(skill)
    writer.signature = writer.signature.with_instructions(instructions)
    assert writer.signature.instructions == instructions
    assert writer.skill.plan_template == ""


def test_a_template_with_tabs(skill):
    tabs = skill.with_parameters({"plan_template": TEMPLATE.replace("    ", "\t")})
    assert PlanWriter(tabs).skill == tabs


@pytest.mark.parametrize("before", [PROSE, f"{PROSE}\n```python\nstop()\n```\nEnd."])
@pytest.mark.parametrize("template", [BLIND, 'x = """```"""\nstop()', "# ````\nstop()", ""])
def test_a_template_that_is_put_in_is_read_back(before, template):
    text = with_template(before, template)
    assert template_of(text) == template.strip("\n")
    assert template_of(with_template(text, TEMPLATE)) == TEMPLATE.strip()
    assert text.count("End.") == before.count("End.")


def test_what_surrounds_the_template_stays(skill):
    writer = PlanWriter(skill)
    writer.signature = writer.signature.with_instructions(f"One.\n```python\n{BLIND}```\nTwo.")
    writer.skill = skill
    assert writer.signature.instructions == f"One.\n```python\n{TEMPLATE}```\nTwo."


def test_another_template_for_one_call(skill, server):
    server.script = [field("plan", BLIND)]
    writer = PlanWriter(skill)
    other = skill.with_parameters({"plan_template": BLIND})
    assert writer.write(other, writer.inputs(other, "go")) == BLIND
    assert BLIND.splitlines()[1] in server.prompts[0]
    assert writer.skill == skill


def test_a_reply_without_the_format_is_asked_for_once_and_traced(skill, server):
    server.script = [f"Here it is:\n```python\n{BLIND}```"]
    writer = PlanWriter(skill)
    with dspy.context(trace=[]):
        assert writer.write(skill, writer.inputs(skill, "go")) == BLIND
        ((predictor, inputs, outputs),) = dspy.settings.trace
    assert (predictor, inputs["task"], outputs.plan) == (writer, "go", BLIND)
    assert len(server.requests) == 1


def test_the_state_of_another_skill(skill):
    state = PlanWriter(skill).dump_state()
    other = PlanWriter(skill.model_copy(update={"name": "swim"}))
    with pytest.raises(SkillError, match="of the skill 'drive'"):
        other.load_state(state)
    assert other.skill.name == "swim"


def test_a_state_with_a_bad_rule_leaves_everything_as_it_is(skill):
    writer = PlanWriter(skill)
    state = writer.dump_state()
    state["skill"]["local_rule"] = "G(((("
    state["signature"]["instructions"] = BLIND
    with pytest.raises(SkillError, match="local rule"):
        writer.load_state(state)
    assert writer.skill == skill


def test_the_state_of_a_plain_predictor_keeps_the_skill(skill):
    state = PlanWriter(skill).dump_state()
    del state["skill"]
    assert PlanWriter(skill).load_state(state).skill == skill
