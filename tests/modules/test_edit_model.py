"""The edit model: its answers in every framework's form, and that they are drawn, not looked up."""

import ast
import asyncio
import copy
import json
from functools import cache

import dspy
import pytest
from dspy.lm15 import Message, Request

import vaso
from vaso.errors import ModelError
from vaso.gradient import propose_edits, textual_gradient
from vaso.gradient.edits import changes_of
from vaso.lm import get_lm
from vaso.modules import EditModel, SkillProgram
from vaso.modules.edit_reading import Reading
from vaso.modules.planner import Planner
from vaso.optimizers.propose_check import RewriteText

SKILLS = ("drive", "bypass-object", "find-object", "fly-in-square-shape-traj")
RULE = "F(!people_observed & !obstacle_observed) -> F(!stop)"


@cache
def initial(name="drive"):
    return vaso.load_skill(name, version="initial")


def edits_of(skill):
    return {e.after for e in propose_edits(skill.plan_template, skill=skill, size=2)}


@cache
def feedback_on(skill):
    return str(textual_gradient(vaso.verify(skill, skill.plan_template), skill=skill))


def inputs_of(skill, **changes):
    return {
        "skill": skill.description,
        "rules": "\n".join(r.text for r in skill.rules),
        "role": "",
        "text": skill.plan_template,
        "other_texts": f"labelling_code:\n{skill.labelling_code}",
        "plan": skill.plan_template,
        "feedback": feedback_on(skill),
        "rejected": "none yet",
        **changes,
    }


def rewritten(lm, skill, adapter=None, **changes):
    with dspy.context(lm=lm, adapter=adapter):
        return dspy.Predict(RewriteText)(**inputs_of(skill, **changes)).new_text


# -- forms -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("adapter", [dspy.ChatAdapter, dspy.JSONAdapter, dspy.XMLAdapter])
def test_dspy(adapter):
    skill = initial()
    text = rewritten(EditModel(), skill, adapter(), feedback=f"violates {RULE}")
    assert text != skill.plan_template
    assert ast.dump(ast.parse(text)) in {ast.dump(ast.parse(e)) for e in edits_of(skill)}


def test_other_fields_get_values_of_their_types():
    class Asked(dspy.Signature):
        text: str = dspy.InputField()
        reasoning: str = dspy.OutputField()
        new_text: str = dspy.OutputField()
        names: list[str] = dspy.OutputField()
        table: dict[str, str] = dspy.OutputField()
        sure: bool = dspy.OutputField()
        size: float = dspy.OutputField()

    with dspy.context(lm=EditModel()):
        found = dspy.Predict(Asked)(text=initial().plan_template)
    assert "line" in found.reasoning
    assert (found.names, found.table, found.sure, found.size) == ([], {}, False, 0.0)


def test_gepa_with_a_text_that_holds_a_fence_itself():
    signature = pytest.importorskip("gepa.strategies.instruction_proposal")
    document = f"Write a plan.\n\n```python\n{initial().plan_template}\n```\n\nKeep it short."
    prompt = signature.InstructionProposalSignature.prompt_renderer(
        {"current_instruction_doc": document, "dataset_with_feedback": [{"Feedback": "no"}]}
    )
    found = signature.InstructionProposalSignature.output_extractor(EditModel()(prompt)[0])
    new = found["new_instruction"]
    assert new != document
    assert new.startswith("Write a plan.\n\n```python\n") and new.endswith("Keep it short.")


def test_gepa():
    signature = pytest.importorskip("gepa.strategies.instruction_proposal")
    skill = initial()
    prompt = signature.InstructionProposalSignature.prompt_renderer(
        {
            "current_instruction_doc": skill.plan_template,
            "dataset_with_feedback": [{"Inputs": "drive", "Feedback": feedback_on(skill)}],
        }
    )
    found = signature.InstructionProposalSignature.output_extractor(EditModel()(prompt)[0])
    assert found["new_instruction"] in {e.strip() for e in edits_of(skill)} - {skill.plan_template}


TEXTGRAD_SYSTEM = "sending the improved variable between <NEW> {improved variable} </NEW> tags."


@pytest.mark.parametrize("short", [False, True])
def test_textgrad(short):
    skill = initial()
    words = skill.plan_template.split(" ")
    shown = " ".join(words[:10]) + " (...) " + " ".join(words[-10:])
    user = (
        f"The variable is the text within the following span: <VARIABLE> "
        f"{shown if short else skill.plan_template} </VARIABLE>\n\n<CONTEXT>In: "
        f"{skill.plan_template} <FEEDBACK>violates {RULE}</FEEDBACK></CONTEXT>"
    )
    request = Request(model="vaso/edits", system=TEXTGRAD_SYSTEM, messages=(Message.user(user),))
    reply = EditModel()(request).message.text
    new = reply.split("<NEW>")[1].split("</NEW>")[0]
    assert new.strip() in {e.strip() for e in edits_of(skill)}


ADALFLOW = """<START_OF_SYSTEM_PROMPT>
Answer as <response><proposed_variable>...</proposed_variable></response>
<END_OF_SYSTEM_PROMPT>
<START_OF_VARIABLE_DESC>
<NAME> plan_template </NAME>
<VARIABLE>{text}</VARIABLE>
<END_OF_VARIABLE_DESC>
1.
PEER_VARIABLE: {labels}
violates {rule}
"""


def test_adalflow_s_own_parser_reads_the_answer():
    parser = pytest.importorskip("xml.etree.ElementTree")
    skill = initial("fly-in-square-shape-traj")
    text = f"{skill.plan_template}\nassert vel_traj[0][0]>-1 & 1 < 2  # ]]> <b>"
    prompt = ADALFLOW.format(text=text, labels=skill.labelling_code, rule="G(altitude < 10)")
    root = parser.fromstring(EditModel()(prompt)[0])
    new = root.find("proposed_variable").text
    assert new != text and "# ]]> <b>" in new and ast.parse(new)
    assert root.find("method").text.startswith(("line", "after", "before"))


def test_criticism_quotes_the_verdicts():
    prompt = (
        "You are the gradient (feedback) engine.\n\n```\nx\n```\n"
        f"violates {RULE}\nline 3 executes `break` in step 1"
    )
    assert EditModel()(prompt)[0] == f"violates {RULE}\nline 3 executes `break` in step 1"


def test_a_request_without_a_plan():
    assert "only edit plans" in EditModel()("What is the capital of France?")[0]


# -- what is edited --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SKILLS)
def test_the_prompt_gives_the_same_edits_as_the_skill(name):
    skill = initial(name)
    template = skill.plan_template
    failures = vaso.verify(skill, template).failures
    known = {e.after for e in propose_edits(template, skill=skill, failures=failures, size=1)}
    reading = Reading("\n\n".join(inputs_of(skill).values()))
    assert {f.formula for f in failures} <= {str(vaso.ltl.parse(f)) for f in reading.violated}
    read, platform = reading.skill(template)
    found = {p.source for _, p in changes_of(template, read, platform, reading.focus(), set())}
    assert platform.name == skill.platform
    assert found == known


@pytest.mark.parametrize(
    "wrapped", ["{}", "### Plan Template\n\n```python\n{}\n```\nKeep it short."]
)
def test_a_plan_inside_a_document(wrapped):
    skill = initial()
    text = wrapped.format(skill.plan_template)
    new = rewritten(EditModel(), skill, text=text)
    before, after = wrapped.split("{}")
    assert new != text and new.startswith(before.strip()) and new.endswith(after.strip())


@pytest.mark.parametrize("name", SKILLS)
def test_labelling_code_and_rules_stay(name):
    skill = initial(name)
    for text in (skill.labelling_code, "\n".join(r.text for r in skill.local_rules)):
        for seed in range(3):
            assert rewritten(EditModel(seed), skill, text=text) == text.strip()


def test_what_was_tried_is_not_drawn_again():
    skill = initial()
    rejected, lm = [], EditModel(skill=skill)
    for number in range(30):
        new = rewritten(lm.copy(rollout_id=number), skill, rejected="\n\n".join(rejected))
        assert new not in rejected
        rejected.append(new)


def test_a_verified_repair_is_made():
    skill = initial()
    result = vaso.verify(skill, skill.plan_template)
    edit = vaso.gradient.find_repair(skill, skill.plan_template)
    advice = str(textual_gradient(result, skill=skill, level="repair", repair=edit))
    made = {rewritten(EditModel(seed), skill, feedback=advice) for seed in range(8)}
    assert edit.after.strip() in made and len(made) < 8


def test_a_plan_for_a_task():
    skill = vaso.load_skill("drive")
    with dspy.context(lm=EditModel()):
        plan = Planner()(skill, "Move forward 5 meters, then turn left.").plan
    assert "legs = [(5.0, 90.0)]" in plan.source
    assert vaso.verify(skill, plan)


def test_plans_of_a_skill_program():
    with dspy.context(lm=EditModel()):
        good = SkillProgram("drive")("Move forward 5 meters, then turn left.")
        bad = SkillProgram(initial(), attempts=4)("Move forward 5 meters.")
    assert good.verified and len(good.attempts) == 1
    assert "legs = [(5.0, 90.0)]" in good.source
    tried = [attempt.plan.source for attempt in bad.attempts]
    assert tried[0] == initial().plan_template + "\n"
    assert len(tried) > 1 and len(set(tried)) == len(tried)


# -- a model like others ---------------------------------------------------------------------------


def test_answers_depend_on_seed_request_and_rollout_alone():
    skill = initial()
    draws = {seed: rewritten(EditModel(seed), skill) for seed in range(6)}
    assert draws == {seed: rewritten(EditModel(seed), skill) for seed in range(6)}
    assert len(set(draws.values())) > 1
    lm = EditModel()
    rolled = {n: rewritten(lm.copy(rollout_id=n), skill) for n in range(6)}
    assert len(set(rolled.values())) > 1
    assert rewritten(copy.deepcopy(lm).copy(rollout_id=3), skill) == rolled[3]
    with pytest.warns(UserWarning, match="rollout_id has no effect"):
        cold = {rewritten(lm.copy(rollout_id=n, temperature=0), skill) for n in range(6)}
    assert len(cold) == 1


def test_async_and_usage():
    prompt = f"```\n{initial().plan_template}\n```"
    lm = EditModel(3)
    with dspy.track_usage() as tracker:
        assert asyncio.run(lm.acall(prompt)) == lm(prompt)
    used = tracker.get_total_tokens()["vaso/edits"]
    assert used["prompt_tokens"] == 2 * -(-len(prompt) // 4)
    assert len(lm.history) == 2


def test_a_program_with_the_model_is_saved_and_loaded(tmp_path):
    program = dspy.Predict(RewriteText)
    program.lm = EditModel(5, skill=initial(), temperature=0.5)
    program.save(tmp_path / "program.json")
    assert json.loads((tmp_path / "program.json").read_text())["lm"]["seed"] == 5
    loaded = dspy.Predict(RewriteText)
    loaded.load(tmp_path / "program.json", allow_unsafe_lm_state=True)
    assert isinstance(loaded.lm, EditModel)
    assert (loaded.lm.seed, loaded.lm.skill) == (5, initial())
    assert loaded.lm.kwargs["temperature"] == 0.5
    assert rewritten(loaded.lm, initial()) == rewritten(program.lm, initial())


def test_by_name():
    assert get_lm("edits").seed == 0
    assert get_lm("edits:7", temperature=1.0).kwargs["temperature"] == 1.0
    assert get_lm("edits:7").seed == 7
    with pytest.raises(ModelError, match="not a number"):
        get_lm("edits:many")


def test_the_loop_repairs_a_skill_with_it():
    def run():
        return vaso.optimize(
            initial(), ["Move forward for 5 meters."], optimizer="loop", lm=EditModel(1)
        )

    first, again = run(), run()
    assert first.verified
    assert first.skill == again.skill and len(first.steps) == len(again.steps)
