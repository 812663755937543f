"""The verifier as a TextGrad loss, in plain TextGrad programs."""

import logging

import dspy
import pytest
from documents import blocks, files, run_page
from openai_server import OpenAIServer, prompt_of

from vaso import Plan
from vaso.errors import ModelError, OptimizerError, SkillError
from vaso.modules.textgrad import DspyEngine, VerifierLoss
from vaso.optimizers.textgrad_setup import backward_engine
from vaso.skill_file import load_skill

import textgrad as tg  # isort: skip

FAULTY = load_skill("drive", version="initial").plan_template
GOOD = """while True:
    if people_observed():
        stop()
    elif obstacle_observed():
        stop()
    else:
        forward()"""
VIOLATES = "violates F(!people_observed & !obstacle_observed) -> F !stop"
LINE = "line 3 `break` leaves the loop"


class Engine(tg.EngineLM):
    """An engine with one reply that keeps its prompts."""

    model_string = "test"

    def __init__(self, reply="feedback"):
        self.reply, self.prompts = reply, []

    def generate(self, prompt, system_prompt=None, **kwargs):
        self.prompts.append(prompt)
        return self.reply

    def __call__(self, *args, **kwargs):
        return self.generate(*args, **kwargs)


def variable(text=FAULTY, **options):
    return tg.Variable(text, role_description="a plan for a robot", **options)


def backward(loss, engine=None):
    engine = engine or Engine()
    with backward_engine(engine):
        loss.backward()
    return engine


@pytest.fixture
def no_engine_is_left():
    yield
    assert tg.SingletonBackwardEngine().get_engine() is None


def test_the_documented_program_runs_as_pasted(tmp_path):
    def answer(request):
        prompt = prompt_of(request)
        assert VIOLATES in prompt and LINE in prompt
        return f"<IMPROVED_VARIABLE>\n{GOOD}\n</IMPROVED_VARIABLE>"

    with OpenAIServer(default=answer) as server:
        done = run_page("textgrad.md", server, tmp_path)
    assert done.returncode == 0 and done.stderr == ""
    (shown,) = blocks("textgrad.md", "text")
    assert done.stdout == shown + GOOD + "\n"
    assert len(server.requests) == 1, "the verifier writes the gradients"
    assert files(tmp_path / "work") == []
    assert {path.relative_to(tmp_path / "home").parts[0] for path in files(tmp_path / "home")} <= {
        ".dspy_cache"
    }


def test_the_loss_says_what_is_wrong():
    loss_fn = VerifierLoss("drive")
    loss = loss_fn(variable())
    assert isinstance(loss, tg.Variable)
    assert loss.value.startswith("FAIL: safety 0.75") and VIOLATES in loss.value
    assert LINE in loss.value and "  3 |         break" in loss.value
    assert loss_fn.score == loss.score == 0.75 and not loss_fn.verified
    assert not loss_fn.result and loss.result.failures[0].counterexample is not None
    good = loss_fn(variable(GOOD))
    assert good.value.startswith("PASS: safety 1.00") and loss_fn.verified and loss_fn.result
    assert loss.score == 0.75, "a loss keeps its own value"


@pytest.mark.parametrize("level", ["verdict", "trace", "blame", "repair"])
def test_the_gradient_is_the_counterexample_at_the_chosen_level(level):
    plan = variable()
    engine = backward(VerifierLoss("drive", level=level)(plan))
    said = plan.get_gradient_text()
    assert VIOLATES in said and engine.prompts == []
    assert ("people_observed (line 2)" in said) == (level != "verdict")
    assert (LINE in said) == (level in ("blame", "repair"))
    assert ("A verified repair" in said) == (level == "repair")


def test_the_optimizer_sees_the_whole_plan_the_rules_and_the_counterexample():
    plan, engine = variable(), Engine(f"<IMPROVED_VARIABLE>{GOOD}</IMPROVED_VARIABLE>")
    backward(VerifierLoss("drive")(plan), engine)
    tg.TGD(parameters=[plan], engine=engine).step()
    (prompt,) = engine.prompts
    for part in (VIOLATES, LINE, "3 |         break", "G(speed < 0.5)", "def turn_left()"):
        assert part in prompt
    assert plan.value == GOOD


def test_the_backward_engine_may_comment():
    plan, engine = variable(), Engine("wait instead of leaving the loop")
    backward(VerifierLoss("drive", backward="engine")(plan), engine)
    assert plan.get_gradient_text() == "wait instead of leaving the loop"
    (prompt,) = engine.prompts
    assert VIOLATES in prompt and LINE in prompt and "3 |         break" in prompt


def test_losses_add_up_and_gradients_go_through_other_functions():
    plan = variable()
    loss_fn = VerifierLoss("drive")
    backward(tg.sum([loss_fn(plan), loss_fn(plan)]))
    assert [VIOLATES in g.value for g in plan.gradients] == [True, True]
    plan = variable()
    engine = backward(tg.aggregate([loss_fn(plan), loss_fn(plan)]), Engine("both in one"))
    assert plan.get_gradient_text() == "both in one" and VIOLATES in engine.prompts[-1]


def test_what_came_after_the_loss_is_answered_by_the_engine():
    plan, engine = variable(), Engine("make the verdict shorter")
    loss = VerifierLoss("drive")(plan)
    report = tg.autograd.llm_ops.LLMCall(engine)(loss)
    backward(report, engine)
    assert "make the verdict shorter" in plan.get_gradient_text()


def test_variables_that_need_no_gradient_get_none():
    plan = variable(requires_grad=False)
    backward(VerifierLoss("drive")(plan))
    assert plan.gradients == set()


def test_texts_of_a_skill():
    drive = load_skill("drive", version="initial")
    task = "Drive straight for 3 meters and stop."
    loss_fn = VerifierLoss(drive, text="plan_template")
    assert loss_fn(variable(), task).score == 0.75
    assert loss_fn(variable(GOOD), task).score == 1.0 and loss_fn.verified
    loss = loss_fn(variable("while True:\n    stop()"), task)
    assert loss.score == 0.0 and not loss_fn.verified
    assert "gives up its task: forward is executed never" in loss.value
    loss = loss_fn(variable("while True"), task)
    assert loss.score == 0.0 and loss_fn.result is None and "is not Python" in loss.value

    labels = VerifierLoss(drive, text="labelling_code")
    lie = drive.labelling_code.replace('yolo_listener("people")', "False")
    assert labels(variable(drive.labelling_code), task).score == 0.75
    assert "do not tell the truth" in labels(variable(lie), task).value and labels.score == 0.0

    rule = VerifierLoss("drive", text="local_rule")
    assert rule(variable("F forward &"), task).score == 0.0 and "LTL" in rule(variable("(")).value
    assert rule(variable("F(!people_observed) -> F(!stop)"), task).score > 0.5


def test_a_planner_of_ones_own():
    asked = []

    def planner(skill, task):
        asked.append(task)
        return Plan(source=skill.plan_template)

    loss_fn = VerifierLoss("drive", text="plan_template", planner=planner)
    assert loss_fn(variable(GOOD), "go").score == 1.0 and "go" in asked


def test_nothing_is_verified_twice(monkeypatch):
    from vaso.modules import judging

    calls, verify = [], judging.verify
    monkeypatch.setattr(judging, "verify", lambda *a, **k: calls.append(a) or verify(*a, **k))
    loss_fn = VerifierLoss("drive")
    for text in (FAULTY, GOOD, FAULTY, GOOD):
        backward(loss_fn(variable(text)))
    assert len(calls) == 2


def test_mistakes_are_explained():
    with pytest.raises(OptimizerError, match="no text 'template'"):
        VerifierLoss("drive", text="template")
    with pytest.raises(OptimizerError, match="'verifier' or 'engine'"):
        VerifierLoss("drive", backward="model")
    with pytest.raises(SkillError):
        VerifierLoss("no-such-skill")
    with pytest.raises(OptimizerError, match=r"a textgrad\.Variable"):
        VerifierLoss("drive")("a plan as text")
    with pytest.raises(OptimizerError, match="nothing was verified yet"):
        _ = VerifierLoss("drive").score
    assert VerifierLoss("drive")(variable("not Python (")).score == 0.0


# -- the engine ------------------------------------------------------------------------------------


def test_an_engine_over_any_dspy_lm():
    with OpenAIServer(["one", "", "three"]) as server:
        engine = DspyEngine(server.lm(temperature=0.3))
        assert engine("prompt", system_prompt="system") == "one"
        assert engine.generate(["a", "b"], temperature=0.9) == ""
        assert tg.BlackboxLLM(engine)(variable("a question")).value == "three"
    assert server.prompts[0] == "system\n\nprompt" and server.prompts[1] == "a\n\nb"
    assert [r["temperature"] for r in server.requests] == [0.3, 0.9, 0.3]
    assert engine.model_string == "openai/test"


def test_an_engine_counts_usage():
    with OpenAIServer(default="fine") as server, dspy.track_usage() as usage:
        DspyEngine(server.lm())("how are you")
    assert usage.get_total_tokens()["openai/test"]["prompt_tokens"] == 3


def test_an_engine_without_a_model_or_with_images(monkeypatch):
    monkeypatch.delenv("VASO_LM", raising=False)
    with dspy.context(lm=None), pytest.raises(ModelError, match="no language model"):
        DspyEngine()
    with OpenAIServer() as server, pytest.raises(OptimizerError, match="text only"):
        DspyEngine(server.lm())(["look", b"\x89PNG"])


# -- manners ---------------------------------------------------------------------------------------


def test_textgrad_writes_no_log_files():
    handlers = logging.getLogger("textgrad").handlers
    assert not [h for h in handlers if isinstance(h, logging.FileHandler)]


def test_the_engine_of_the_user_is_put_back(no_engine_is_left):
    mine = Engine()
    tg.set_backward_engine(mine)
    try:
        with pytest.raises(ZeroDivisionError), backward_engine(Engine()):
            raise ZeroDivisionError
        assert tg.SingletonBackwardEngine().get_engine() is mine
    finally:
        tg.SingletonBackwardEngine().set_engine(None, override=True)
