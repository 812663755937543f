import asyncio
import json
import re

import dspy
import pytest
from openai_server import prompt_of
from vaso_scripts import BLIND, TEMPLATE, field

from vaso.errors import SkillError
from vaso.gradient.model import PASS_TEXT
from vaso.modules import SkillProgram, SkillRouter, SymbolicPlanner, verifier_metric
from vaso.plan import Plan

TASKS = [dspy.Example(task=f"drive {n} meters").with_inputs("task") for n in range(4)]


def pred(plan):
    return dspy.Prediction(plan=plan)


# -- scores --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("plan", "score", "told"),
    [
        (TEMPLATE, 1.0, PASS_TEXT),
        (f"Here:\n```python\n{TEMPLATE}```", 1.0, PASS_TEXT),
        (Plan(source=TEMPLATE), 1.0, PASS_TEXT),
        (BLIND, 0.5, "violates G(people_observed -> X stop)"),
        ("stop(", 0.0, "not valid Python"),
        ("", 0.0, "There is no plan"),
        (None, 0.0, "There is no plan"),
        (Plan(source=" "), 0.0, "There is no plan"),
    ],
)
def test_score_and_feedback(skill, plan, score, told):
    found = verifier_metric(skill)(None, pred(plan))
    assert found.score == score
    assert told in found.feedback


def test_a_prediction_without_a_plan(skill):
    assert verifier_metric(skill)(None, None).score == 0.0
    assert verifier_metric(skill)(None, dspy.Prediction(answer="x")).score == 0.0


def test_a_plan_in_another_field(skill):
    found = verifier_metric(skill, field="code")(None, dspy.Prediction(code=TEMPLATE))
    assert found.score == 1.0


def test_a_number_alone(skill):
    metric = verifier_metric(skill, feedback=False)
    assert metric(None, pred(BLIND)) == 0.5
    assert type(metric(None, pred(TEMPLATE))) is float


def test_a_demonstration_must_be_verified(skill):
    """Half of the rules is truthy, and still no example to follow."""
    metric = verifier_metric(skill)
    assert metric(None, pred(BLIND), trace=[]) is False
    assert metric(None, pred(TEMPLATE), trace=[]) is True
    assert metric(None, pred(BLIND), [], "write", []).score == 0.5


def test_the_level_of_the_feedback(skill):
    short = verifier_metric(skill, level="verdict")(None, pred(BLIND)).feedback
    assert short == "violates G(people_observed -> X stop)"
    assert "Line 2" in verifier_metric(skill, level="blame")(None, pred(BLIND)).feedback
    repair = verifier_metric(skill, level="repair")(None, pred(f"forward()\n{TEMPLATE}"))
    assert "A verified repair" in repair.feedback


def test_shipped_skills_by_name():
    assert verifier_metric("drive")(None, pred("stop()")).score < 1.0
    with pytest.raises(SkillError, match="no skill"):
        verifier_metric("drvie")
    with pytest.raises(SkillError, match="no level 'much'"):
        verifier_metric("drive", level="much")


def test_the_prediction_s_own_skill(skill):
    found = SkillProgram(skill, SymbolicPlanner())(task="drive")
    assert verifier_metric()(None, found).score == 1.0
    with pytest.raises(SkillError, match="which skill"):
        verifier_metric()(None, pred(TEMPLATE))


def test_the_metric_s_skill_counts_more_than_the_prediction_s(skill):
    """A program that was given laxer rules is judged by the strict ones all the same."""
    lax = skill.model_copy(update={"global_rules": ()}).with_parameters({"plan_template": BLIND})
    found = SkillProgram(lax, SymbolicPlanner())(task="drive")
    assert found.verified
    assert verifier_metric(skill)(None, found).score == 0.5


def test_no_text_is_verified_twice(skill, verdicts):
    program, metric = SkillProgram(skill, SymbolicPlanner()), verifier_metric(skill)
    for _ in range(3):
        metric(None, program(task="drive"))
        metric(None, pred(BLIND))
        verifier_metric(skill, level="trace")(None, pred(BLIND))
    assert verdicts.verifications == 2


def test_a_router_s_parts_count(skill):
    endless = skill.model_copy(update={"name": "endless"})
    router = SkillRouter([skill, endless], SymbolicPlanner())
    found = router(instruction="x", steps=[("drive", "a"), ("endless", "b")])
    assert found.result
    score = verifier_metric()(None, found)
    assert 0.0 < score.score < 1.0
    assert "never reached" in score.feedback


# -- in dspy -------------------------------------------------------------------------------------


def test_evaluate(skill, server):
    server.script = [field("plan", TEMPLATE), field("plan", BLIND)]
    program = dspy.Predict("task -> plan")
    evaluate = dspy.Evaluate(devset=TASKS[:2], metric=verifier_metric(skill), num_threads=1)
    assert evaluate(program).score == 75.0


def new_instructions(template: str) -> str:
    return f"Write a plan. Follow the template.\n\n```python\n{template}```"


def test_gepa_rewrites_the_template_of_a_program_with_a_symbolic_planner(skill, server, verdicts):
    """One question to the reflection model; every plan is drawn without one."""
    server.default = json.dumps({"new_instruction": new_instructions(TEMPLATE)})
    student = SkillProgram(
        skill.with_parameters({"plan_template": BLIND}), SymbolicPlanner(), attempts=1
    )
    gepa = dspy.GEPA(
        metric=verifier_metric(), max_metric_calls=10, reflection_lm=server.lm(), num_threads=2
    )
    best = gepa.compile(student, trainset=TASKS, valset=TASKS)
    assert best.skill.plan_template == TEMPLATE.strip()
    assert best(task="drive").verified
    assert student.skill.plan_template == BLIND.strip()
    assert "Line 2 executes forward() in step 1" in server.prompts[0]
    assert BLIND in server.prompts[0]
    assert len(server.requests) == 1
    assert verdicts.verifications == 2


def test_gepa_with_a_model_that_follows_its_instructions(skill, server):
    """The planning model writes what the template in its instructions says."""

    def answer(request):
        prompt = json.dumps(request["messages"])
        if "new_instruction" in prompt:
            return json.dumps({"new_instruction": new_instructions(TEMPLATE)})
        return field("plan", TEMPLATE if "if people_observed():" in prompt else BLIND)

    server.default = answer
    student = SkillProgram(skill.with_parameters({"plan_template": BLIND}), attempts=1)
    gepa = dspy.GEPA(
        metric=verifier_metric(skill), max_metric_calls=9, reflection_lm=server.lm(), num_threads=1
    )
    best = gepa.compile(student, trainset=TASKS[:2], valset=TASKS[:2])
    assert best(task="drive").verified
    assert best.skill.plan_template == TEMPLATE.strip()


def test_simba_chooses_demonstrations(skill, server):
    """A model that hits on a good plan by chance, and imitates any that it is shown."""
    count = iter(range(1_000))

    def answer(request):
        shown = "if people_observed():" in json.dumps(request["messages"])
        return field("plan", TEMPLATE if shown or next(count) % 2 == 0 else BLIND)

    server.default = answer
    faulty = skill.with_parameters({"plan_template": BLIND})
    simba = dspy.SIMBA(
        metric=verifier_metric(), bsize=2, num_candidates=2, max_steps=1, max_demos=1, num_threads=1
    )
    simba.strategies = simba.strategies[:1]
    best = simba.compile(SkillProgram(faulty, attempts=1), trainset=TASKS[:2], seed=0)
    (demo,) = best.write.demos
    assert TEMPLATE.strip() in demo["plan"]
    assert best(task="drive").verified


def proposes_instructions(request):
    """A model that proposes good instructions, and writes what its instructions show."""
    prompt = prompt_of(request)
    outputs = prompt.partition("output fields are")[2].partition("All interactions")[0]
    good = TEMPLATE if "if people_observed():" in prompt else BLIND
    values = {"plan": good, "proposed_instruction": new_instructions(TEMPLATE)}
    return "\n\n".join(
        f"[[ ## {name} ## ]]\n{values.get(name, 'A robot drives.')}"
        for name in [*re.findall(r"`(\w+)`", outputs), "completed"]
    )


@pytest.mark.parametrize("name", ["mipro", "copro"])
def test_optimizers_that_propose_instructions(skill, server, name):
    server.default = proposes_instructions
    metric = verifier_metric(skill, feedback=False)
    student = SkillProgram(skill.with_parameters({"plan_template": BLIND}), attempts=1)
    if name == "copro":
        best = dspy.COPRO(metric=metric, breadth=2, depth=1).compile(
            student, trainset=TASKS[:2], eval_kwargs={"num_threads": 1}
        )
    else:
        mipro = dspy.MIPROv2(
            metric=metric, auto=None, num_candidates=2, max_bootstrapped_demos=0,
            max_labeled_demos=0, num_threads=1,
        )  # fmt: skip
        best = mipro.compile(
            student, trainset=TASKS[:2], valset=TASKS[2:], num_trials=3, minibatch=False
        )
    assert best.skill.plan_template == TEMPLATE.strip()
    assert best(task="drive").verified


def test_bootstrapped_demonstrations_are_verified_plans(skill, server):
    server.script = [field("plan", BLIND), field("plan", TEMPLATE)]
    optimizer = dspy.BootstrapFewShot(
        metric=verifier_metric(skill), max_bootstrapped_demos=1, max_labeled_demos=0
    )
    best = optimizer.compile(SkillProgram(skill, attempts=1), trainset=TASKS[:2])
    (demo,) = best.write.demos
    assert demo["plan"].strip() == TEMPLATE.strip()
    assert demo["task"] == "drive 1 meters"


def test_best_of_n(skill, server, memory_cache):
    server.script = [field("plan", BLIND), field("plan", TEMPLATE)]
    metric = verifier_metric(skill, feedback=False)
    with dspy.context(lm=server.lm(cache=True)):
        best = dspy.BestOfN(
            SkillProgram(skill, attempts=1),
            N=3,
            reward_fn=lambda args, pred: metric(None, pred),
            threshold=1.0,
        )
        assert best(task="drive").verified
    assert len(server.requests) == 2


def test_in_a_coroutine(skill, server):
    server.default = field("plan", TEMPLATE)

    async def main():
        found = await SkillProgram(skill).acall(task="drive")
        return verifier_metric()(None, found).score

    assert asyncio.run(main()) == 1.0
