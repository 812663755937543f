"""A skill as an AdalFlow component and the verifier as its loss, in plain AdalFlow programs."""

import copy
import json
import pickle
from dataclasses import dataclass

import pytest
from documents import blocks, files, run_page
from openai_server import OpenAIServer, Status, prompt_of

from vaso.errors import OptimizerError, SkillError
from vaso.modules.adalflow import (
    DrawnPlan,
    DspyClient,
    SkillComponent,
    TextOptimizer,
    VerifierLoss,
)
from vaso.optimizers.adalflow_setup import caches_in
from vaso.skill_file import load_skill

import adalflow as adal  # isort: skip
from adalflow.core.generator import BackwardEngine  # isort: skip
from adalflow.core.types import GeneratorOutput  # isort: skip

DRIVE = load_skill("drive", version="initial")
TASK = "Drive straight for 3 meters and stop."
GOOD = """while True:
    if people_observed():
        stop()
    elif obstacle_observed():
        stop()
    else:
        forward()"""
VIOLATES = "violates F(!people_observed & !obstacle_observed) -> F !stop"
LINE = "line 3 `break` leaves the loop"


def proposal(text):
    return (
        f"<response><reasoning>a & b < c</reasoning><method>edit</method>"
        f"<proposed_variable>{text}</proposed_variable></response>"
    )


def answer(request):
    """Feedback, or a proposal in AdalFlow's format: its XML escapes nothing."""
    prompt = prompt_of(request)
    if "<proposed_variable>The proposed" not in prompt:
        return "wait instead of leaving the loop"
    return proposal(DRIVE.labelling_code if "<NAME> labelling_code" in prompt else GOOD)


@pytest.fixture(autouse=True)
def no_files_at_home(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    with caches_in(str(tmp_path)):
        yield


@pytest.fixture
def server():
    with OpenAIServer(default=answer) as running:
        yield running


def model_of(server, **options):
    return {"model_client": DspyClient(server.lm(**options)), "model_kwargs": {"model": "test"}}


# -- whole programs --------------------------------------------------------------------------------


def test_the_documented_program_runs_as_pasted(server, tmp_path):
    done = run_page("adalflow.md", server, tmp_path)
    assert done.returncode == 0, done.stderr
    (shown,) = blocks("adalflow.md", "text")
    assert done.stdout.endswith(shown) and shown.split() == ["pass"] * 5
    assert len(server.requests) == 6  # feedback on 2 samples x 2 texts, a proposal for each text
    assert all(VIOLATES in prompt and LINE in prompt for prompt in server.prompts)
    assert files(tmp_path / "work") == []
    saved = [path.read_bytes() for path in files(tmp_path / "home") if path.suffix == ".json"]
    assert saved and not any(b"sk-secret" in text for text in saved)


@dataclass
class Sample:
    id: str
    prompt: str


SAMPLES = [
    Sample("0", TASK),
    Sample("1", "Move forward for 2 meters and rotate right by 45 degrees."),
]


class Plain(adal.AdalComponent):
    """The least that AdalFlow asks for."""

    def __init__(self, task, loss, model):
        super().__init__(
            task=task,
            eval_fn=loss.safety,
            loss_fn=loss,
            backward_engine_model_config=model,
            text_optimizer_model_config=model,
        )

    def prepare_task(self, sample):
        return self.task, {"task": sample.prompt, "id": sample.id}

    def prepare_eval(self, sample, y_pred):
        return self.eval_fn, {"plan": y_pred.data}

    def prepare_loss(self, sample, pred):
        pred.eval_input = pred.full_response.data
        return self.loss_fn, {"kwargs": {"plan": pred}, "id": sample.id}


def train(component, tmp_path, **options):
    trainer = adal.Trainer(component, max_steps=1, ckpt_path=str(tmp_path / "ckpt"), **options)
    trainer.fit(train_dataset=SAMPLES, val_dataset=SAMPLES)
    return trainer


def test_adalflow_s_own_text_optimizer_works_too(server, tmp_path):
    """As long as the model escapes what XML wants escaped."""
    server.default = lambda request: answer(request).replace("a & b < c", "")
    skill = SkillComponent("drive")
    train(Plain(skill, VerifierLoss(), model_of(server)), tmp_path)
    assert skill.texts == dict(DRIVE.parameters) | {"plan_template": GOOD}


def test_a_planner_that_is_a_generator_of_the_user_s(server, tmp_path):
    """The skill is fixed; what is trained is the prompt of an LLM planner."""

    class Planner(adal.Component):
        def __init__(self, model):
            super().__init__()
            hint = adal.Parameter(
                data="Leave the loop.", role_desc="hint", param_type=adal.ParameterType.PROMPT
            )
            self.write = adal.Generator(
                **model, template="{{hint}}\nTask: {{task}}", prompt_kwargs={"hint": hint}
            )

        def bicall(self, task, id=None):
            return self.write(prompt_kwargs={"task": task}, id=id)

    def reply(request):
        prompt = prompt_of(request)
        if "<proposed_variable>The proposed" in prompt:
            return proposal("Wait in the loop.")
        if "<OBJECTIVE_INSTRUCTION>" in prompt:
            return "the hint is wrong"
        return GOOD if "Wait in the loop." in prompt else DRIVE.plan_template

    server.default = reply
    component = Plain(Planner(model_of(server)), VerifierLoss("drive"), model_of(server))
    component.configure_optimizers = lambda **_: [
        TextOptimizer(component.task.parameters(), **model_of(server))
    ]
    trainer = train(component, tmp_path)
    (hint,) = [p for p in trainer.adaltask.task.parameters() if p.requires_opt]
    assert hint.data == "Wait in the loop."
    assert any(VIOLATES in prompt for prompt in server.prompts)


# -- the component ---------------------------------------------------------------------------------


def test_a_call_draws_a_plan_and_training_makes_it_a_parameter():
    skill = SkillComponent("drive")
    output = skill(task=TASK, id="7")
    assert isinstance(output, GeneratorOutput) and output.id == "7"
    assert isinstance(output.data, str) and output.data.startswith("while True")
    skill.train()
    plan = skill(task=TASK, id="7")
    assert isinstance(plan, adal.Parameter) and plan.data.data == plan.eval_input == output.data
    names = {p.name for p in plan.predecessors}
    assert names == {"task", "rules", "local_rule", "labelling_code", "plan_template"}


def test_the_skill_follows_its_texts():
    skill = SkillComponent(DRIVE, trainable=("plan_template",))
    assert skill.skill == DRIVE
    assert [p.name for p in skill.parameters() if p.requires_opt] == ["plan_template"]
    skill.plan_template.update_value(GOOD)
    assert skill.skill.plan_template == GOOD and skill.call(TASK).data == GOOD
    assert skill.skill.global_rules == DRIVE.global_rules
    with pytest.raises(SkillError):
        SkillComponent("no-such-skill")
    with pytest.raises(OptimizerError):
        SkillComponent(DRIVE, trainable=("template",))


def test_a_planner_of_ones_own():
    from vaso import Plan

    skill = SkillComponent(DRIVE, planner=lambda skill, task: Plan(source=GOOD))
    assert VerifierLoss().safety(skill.call("anything")) == 1.0


def test_the_counterexample_flows_to_the_texts_without_a_model():
    skill, loss = SkillComponent("drive"), VerifierLoss()
    total = loss({"plan": skill.forward(TASK, id="0")})
    assert total.data == 0.75
    total.backward()
    for text in (skill.plan_template, skill.labelling_code):
        (gradient,) = text.gradients
        assert VIOLATES in gradient.data and LINE in gradient.data
    assert list(skill.local_rule.gradients) == []


def test_the_backward_engine_is_asked_for_each_text(server):
    skill, loss = SkillComponent("drive"), VerifierLoss()
    skill.set_backward_engine(BackwardEngine(**model_of(server), use_cache=False))
    loss({"plan": skill.forward(TASK, id="0")}).backward()
    (gradient,) = skill.plan_template.gradients
    assert "wait instead of leaving the loop" in gradient.data and VIOLATES in gradient.data
    assert len(server.requests) == 2


def test_a_verified_plan_gets_no_criticism(server):
    skill = SkillComponent(DRIVE.with_parameters({"plan_template": GOOD}))
    skill.set_backward_engine(BackwardEngine(**model_of(server), use_cache=False))
    VerifierLoss()({"plan": skill.forward(TASK, id="0")}).backward()
    assert [g.data for g in skill.plan_template.gradients] == ["No noticeable error."]
    assert server.requests == []


def test_gradients_keep_their_order():
    skill, loss = SkillComponent("drive"), VerifierLoss()
    plans = [skill.forward(sample.prompt, id=sample.id) for sample in SAMPLES]
    for plan in plans:
        loss({"plan": plan}).backward()
    assert [g.data_id for g in skill.plan_template.gradients] == ["0", "1"]
    assert len({hash(plan) for plan in plans}) == 2
    again = SkillComponent("drive").forward(TASK, id="0")
    assert hash(again) == hash(plans[0]), "sets have the same order in every run"


# -- the loss --------------------------------------------------------------------------------------


@pytest.mark.parametrize("plan", [DRIVE.plan_template, GeneratorOutput(data=DRIVE.plan_template)])
def test_plans_as_text(plan):
    loss = VerifierLoss("drive", level="verdict")
    assert loss.safety(plan) == 0.75 and str(loss.value(plan).gradient) == VIOLATES
    assert loss.safety("not Python (") == 0.0


def test_it_must_be_known_what_a_plan_is_for():
    with pytest.raises(OptimizerError, match="which skill"):
        VerifierLoss().safety(GOOD)
    with pytest.raises(OptimizerError, match="is no plan"):
        VerifierLoss("drive").safety(GeneratorOutput(data=None, error="the model is down"))


def test_a_plan_that_gives_up_its_task_scores_nothing():
    skill, loss = SkillComponent("drive"), VerifierLoss()
    skill.plan_template.update_value("while True:\n    stop()")
    total = loss({"plan": skill.forward(TASK, id="0")})
    total.backward()
    (gradient,) = skill.plan_template.gradients
    assert total.data == 0.0 and "gives up its task: forward is executed never" in gradient.data


@pytest.mark.parametrize("bad", ["while True", "", "import os\nos.system('true')", "halt()"])
def test_malformed_texts_score_nothing_and_say_why(bad):
    skill, loss = SkillComponent("drive"), VerifierLoss()
    skill.plan_template.update_value(bad)
    total = loss({"plan": skill.forward(TASK, id="0")})
    total.backward()
    assert total.data == 0.0 and len(next(iter(skill.plan_template.gradients)).data) > 20


def test_a_drawn_plan_is_a_text():
    plan = SkillComponent("drive").call(TASK).data
    assert json.loads(json.dumps(plan)) == plan and f"{plan}" == str(plan) == plan
    assert copy.copy(plan) == plan and copy.copy(plan).value.score == plan.value.score
    assert pickle.loads(pickle.dumps(DrawnPlan("stop()"))) == "stop()"


# -- the client ------------------------------------------------------------------------------------


def test_a_client_over_any_dspy_lm(server):
    server.default = "fine"
    ask = adal.Generator(
        model_client=DspyClient(server.lm()),
        model_kwargs={"model": "any", "temperature": 0.2},
        template="How are you, {{name}}?",
        use_cache=False,
    )
    output = ask(prompt_kwargs={"name": "Ada"})
    assert output.data == "fine" and server.prompts == ["How are you, Ada?"]
    assert server.requests[0]["temperature"] == 0.2


def test_each_proposal_is_a_rollout_of_its_own(server, tmp_path):
    """With dspy's cache, a proposal that failed would come back for ever."""
    import dspy

    server.script = ["first", "second", Status(500)]
    with dspy.context():
        client = DspyClient(server.lm(cache=True, temperature=1.0))
        same = {"prompt": f"a question from {tmp_path}"}
        assert [client.call(same), client.call(same)] == ["first", "second"]
    with pytest.raises(Exception, match="scripted error"):
        client.call(same)
    assert len(client.errors) == 1


async def ask_in_a_loop(client):
    return await client.acall({"prompt": "hello"})


def test_a_client_in_an_event_loop(server):
    import asyncio

    server.default = "fine"
    assert asyncio.run(ask_in_a_loop(DspyClient(server.lm()))) == "fine"
