"""Models that follow a skill's grammar, in the modules and in the optimizer."""

import random

import dspy
import pytest
from dspy.utils import DummyLM
from gbnf_reader import Grammar
from grammar_check import check_plan

from vaso.lm import get_lm
from vaso.local import constrained, plan_grammar, rule_grammar
from vaso.local.adapter import BareAdapter, fits
from vaso.local.constrain import follows_grammar
from vaso.modules import Planner, SymbolicPlanner
from vaso.modules.asking import ask, model_of
from vaso.optimizers.base import Case, State
from vaso.optimizers.loss import SkillLoss
from vaso.optimizers.parameters import Parameters
from vaso.optimizers.propose_check import ProposeAndCheck
from vaso.optimizers.rewriting import RewriteText
from vaso.skill_file import load_skill

DRIVE = load_skill("drive", version="initial")
TASK = "Move forward for 2 meters."


@pytest.fixture
def writer(model_path):
    return get_lm(f"local:{model_path}", cache=False, max_tokens=6000)


def test_which_texts_have_a_grammar(writer):
    plan, rule = (constrained(writer, DRIVE, t) for t in ("plan_template", "local_rule"))
    assert plan.kwargs["metadata"]["grammar"] == plan_grammar(DRIVE)
    assert rule.kwargs["metadata"]["grammar"] == rule_grammar(DRIVE)
    assert follows_grammar(plan) and follows_grammar(rule) and not follows_grammar(writer)
    assert constrained(writer, DRIVE, "labelling_code") is writer
    broken = DRIVE.with_parameters({"labelling_code": "def :"})
    assert constrained(writer, broken, "plan_template") is writer


def test_other_models_stay_as_they_are():
    for lm in (dspy.LM("openai/x", api_key="none"), DummyLM([{"plan": "x"}])):
        assert constrained(lm, DRIVE, "plan_template") is lm and not follows_grammar(lm)


def test_rules_that_a_model_writes_are_formulas(writer):
    (text,) = constrained(writer, DRIVE, "local_rule")("Write a rule.")
    assert Grammar.read(rule_grammar(DRIVE)).matches(text)
    assert DRIVE.with_parameters({"local_rule": text}).local_rules


# -- the planner -----------------------------------------------------------------------------------


def test_the_planner_asks_once_and_gets_a_plan_that_compiles(writer):
    with dspy.context(lm=writer, track_usage=True):
        written = Planner()(DRIVE, TASK)
    assert Grammar.read(plan_grammar(DRIVE)).matches(written.source)
    check_plan(written.source, DRIVE)
    assert sum(u["completion_tokens"] for u in written.get_lm_usage().values()) > 0


def test_a_predictor_s_own_model_is_asked(writer, monkeypatch):
    monkeypatch.setenv("VASO_LM", "openai/none")
    planner = Planner()
    planner.set_lm(writer)
    with dspy.context(lm=DummyLM([{"plan": "forward()"}])):
        assert model_of(planner.write) is writer
        assert Grammar.read(plan_grammar(DRIVE)).matches(planner(DRIVE, TASK).source)
        assert ask(dspy.Predict("task -> plan"), "plan", task="x") == "forward()"


# -- the prompt ------------------------------------------------------------------------------------


def test_the_prompt_is_short_and_asks_for_the_text_alone():
    adapter, signature = BareAdapter(), RewriteText
    program = "while True:\n    forward()"
    inputs = dict.fromkeys(signature.input_fields, "none yet")
    inputs |= {"text": program, "plan": program, "feedback": "violates G(x)"}
    system, user = adapter.format(signature, [], inputs)
    assert system["content"].startswith("Rewrite one text") and "[[" not in str((system, user))
    assert user["content"] == (f"## Text\n{program}\n\n## Feedback\nviolates G(x)\n\n## New text")
    assert adapter.parse(signature, "stop()\n") == {"new_text": "stop()\n"}
    assert fits(signature) and not fits(dspy.Signature("a -> b, c"))
    assert not fits(dspy.Signature("a -> b: int"))


def test_demonstrations_are_shown_as_replies():
    signature = dspy.Signature("task -> plan")
    messages = BareAdapter().format(signature, [{"task": "stop", "plan": "stop()"}], {"task": "go"})
    assert [m["role"] for m in messages] == ["system", "user", "assistant", "user"]
    assert messages[2]["content"] == "stop()"


# -- the optimizer ---------------------------------------------------------------------------------


def test_every_proposal_is_a_plan_that_compiles(writer):
    params, case = Parameters(DRIVE), Case(TASK)
    value = SkillLoss(DRIVE, SymbolicPlanner())(params, case)
    state = State(
        step=1,
        seed=0,
        params=params,
        values={case: value},
        history=(),
        rng=random.Random(0),
        lm=writer,
        evaluate=None,
    )
    (found,) = ProposeAndCheck(together=4).propose(state)
    texts = [p.texts["plan_template"] for p in found]
    follows = Grammar.read(plan_grammar(DRIVE))
    assert len(set(texts)) == 4 and all(follows.matches(text) for text in texts)
    for text in texts:
        check_plan(text, DRIVE)
