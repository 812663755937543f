import importlib.util

import dspy
import pytest
from dspy.utils.exceptions import AdapterParseError
from replies import GOOD, RECKLESS
from rewrites import TWO_TASKS, WEAK, Model, fenced, marked, optimize

from vaso.errors import MissingDependencyError
from vaso.gradient.model import Level, TextualGradient
from vaso.optimizers import get_optimizer
from vaso.optimizers.base import Case, LossValue
from vaso.optimizers.budget import Budget
from vaso.optimizers.rewriter import BareReplies, Gain
from vaso.optimizers.rewriting import RewriteText
from vaso.optimizers.session import Outcome
from vaso.optimizers.simba import Simba

TIP = "If a plan leaves a loop, then let it stay in the loop and stop there."


def learner(mark):
    """A model that finds the good text only when the prompt has a mark in it."""
    weak = iter(WEAK)
    return lambda prompt: fenced(GOOD) if mark in prompt else next(weak)


def test_a_rule_that_simba_draws_reaches_the_prompt(server):
    model = Model([learner(TIP)], advice=TIP)
    result, _ = optimize(server, Simba(max_demos=0), model=model, tasks=TWO_TASKS)
    assert result.verified and len(model.asked["advice"]) >= 1
    advice, last = model.asked["advice"][0], model.asked["text"][-1]
    assert "safety would fall" in advice, "the verifier's feedback on the worse rewrite"
    assert "no improvement: safety stays at 0.750" in advice, "and on the better one"
    assert TIP in last and not any(TIP in p for p in model.asked["text"][:6])


def test_a_good_rewrite_becomes_a_demonstration(server):
    def answer(request):
        turns = [m["role"] for m in request["messages"]]
        return fenced(GOOD) if "assistant" in turns else next(weak)

    weak = iter(WEAK)
    result, _ = optimize(server, "simba", model=answer, tasks=TWO_TASKS, seed=1)
    assert result.verified
    demo = next(m for m in server.requests[-1]["messages"] if m["role"] == "assistant")
    assert RECKLESS.strip() not in demo["content"], "it shows the better one"


@pytest.mark.parametrize("advice", ["", marked(discussion="x", module_advice="{")])
def test_advice_that_cannot_be_read_is_none(server, advice, capfd):
    model = Model([*WEAK, fenced(GOOD)], raw_advice=advice)
    result, _ = optimize(server, Simba(max_demos=0), model=model, tasks=TWO_TASKS)
    assert result.verified and capfd.readouterr() == ("", "")


def test_works_with_one_task_and_starts_anew(server):
    result, model = optimize(
        server, Simba(max_steps=1), *WEAK, fenced(GOOD), budget=Budget(steps=20)
    )
    assert result.verified and len(model.texts) == 1


def test_without_numpy(monkeypatch):
    found = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda n, *a: None if n == "numpy" else found(n, *a)
    )
    with pytest.raises(MissingDependencyError, match=r"numpy(.|\n)*--extra simba"):
        get_optimizer("simba")


# -- the metric ------------------------------------------------------------------------------------

FIRST, SECOND = Case("first"), Case("second")


def value(score, lost=()):
    gradient = TextualGradient(level=Level.VERDICT, score=score, passed=score == 1, verdict="bad")
    return LossValue(score, lambda: gradient, lost=lost)


class Rewrites:
    """A session that has one outcome."""

    def __init__(self, outcome):
        self.outcome, self.session = outcome, self
        self.values = {FIRST: value(0.5), SECOND: value(0.75)}
        self.failures = []

    def offer(self, texts, note):
        if isinstance(self.outcome, Exception):
            raise self.outcome
        return self.outcome

    def failed(self, error):
        self.failures.append(error)


def gain(outcome, trace=None, prediction=None):
    prediction = prediction or dspy.Prediction(name="plan_template", new_text="x")
    return Gain(Rewrites(outcome))(None, prediction, trace)


@pytest.mark.parametrize(
    ("values", "score"),
    [
        ({}, 0.0),
        ({FIRST: value(0.5), SECOND: value(0.75)}, 0.5),
        ({FIRST: value(1.0), SECOND: value(1.0)}, 0.6875),
        ({FIRST: value(0.0)}, 0.25),
        ({FIRST: value(1.0, lost=("it does not drive",)), SECOND: value(0.75)}, 0.375),
    ],
)
def test_the_score_is_what_a_rewrite_gains(values, score):
    found = gain(Outcome(False, "turned down", values))
    assert found.score == pytest.approx(score) and found.feedback.startswith("turned down")
    assert ("bad" in found.feedback) == any(not v.verified for v in values.values())


def test_only_what_was_accepted_is_a_demonstration():
    assert gain(Outcome(True, "", {FIRST: value(1.0)}), trace=[]) is True
    assert gain(Outcome(False, "no", {FIRST: value(1.0)}), trace=[]) is False
    assert gain(ValueError("the planner is away"), trace=[]) is False


def test_no_answer_scores_nothing():
    nothing = dspy.Prediction(name="plan_template", new_text=None)
    for prediction in (None, nothing):
        assert Gain(Rewrites(None))(None, prediction).score == 0.0
    rewrites = Rewrites(ValueError("the planner is away"))
    found = Gain(rewrites)(None, dspy.Prediction(name="plan_template", new_text="x"))
    assert found.score == 0.0 and "away" in str(rewrites.failures)


def test_replies_without_marks():
    adapter = BareReplies()
    assert adapter.parse(RewriteText, "stop()") == {"new_text": "stop()"}
    assert adapter.parse(RewriteText, marked(new_text="stop()")) == {"new_text": "stop()"}
    for signature in ("a -> b, c", "a -> b: int"):
        with pytest.raises(AdapterParseError):
            adapter.parse(dspy.Signature(signature), "stop()")
