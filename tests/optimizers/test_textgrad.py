"""The steps of ``textgrad``, with a loss that reads its values from the text."""

import threading

import pytest
from fakes import CASES, SKILL, FakeLoss, template
from openai_server import Status, prompt_of
from replies import tagged

from vaso.optimizers import get_optimizer
from vaso.optimizers.base import Case
from vaso.optimizers.budget import Budget
from vaso.optimizers.parameters import Parameters
from vaso.optimizers.textgrad import TextGrad
from vaso.optimizers.textgrad_setup import import_textgrad

PROPOSAL = "<IMPROVED_VARIABLE>{"
LABELS = "<ROLE>the labelling code"


def run(server, *replies, labels=SKILL.labelling_code, optimizer=None, loss=None, **options):
    """Replies are the proposals for the template; texts of their own have their tags already."""
    templates, labellings = list(replies), labels if isinstance(labels, list) else [labels]

    def answer(request):
        prompt = prompt_of(request)
        if PROPOSAL not in prompt:
            return "feedback of the engine"
        found = labellings if LABELS in prompt else templates
        reply = found.pop(0) if len(found) > 1 else found[0]
        return tagged(reply) if isinstance(reply, str) and "<" not in reply else reply

    server.default = answer
    options.setdefault("budget", Budget(steps=max(1, len(replies))))
    params = options.pop("params", None) or Parameters(SKILL)
    cases = options.pop("cases", CASES)
    chosen = get_optimizer(optimizer or TextGrad())
    return chosen.optimize(params, loss or FakeLoss(), cases, lm=server.lm(), **options)


def proposals(server):
    return [p for p in server.prompts if PROPOSAL in p and LABELS not in p]


def test_the_best_so_far_is_what_each_step_starts_from(server):
    result = run(server, template(0.8), template(0.6), template(0.9), template(1.0))
    assert [s.accepted for s in result.steps] == [True, False, True, True] and result.verified
    for prompt, start in zip(proposals(server), (0.5, 0.8, 0.8, 0.9), strict=True):
        assert f"<VARIABLE> score = {start} </VARIABLE>" in prompt


def test_what_was_turned_down_and_why_is_feedback_to_the_next_steps(server):
    tries = [template(s) for s in (0.1, 0.2, 0.3, 0.4, 0.8, 0.9)]
    run(server, *tries)
    prompts = proposals(server)
    assert "turned down" not in prompts[0]
    assert "turned down because safety" in prompts[1] and "score = 0.1" in prompts[1]
    assert "score = 0.1" not in prompts[4], "the last three are enough"
    assert all(f"score = {s}" in prompts[4] for s in (0.2, 0.3, 0.4))
    assert "turned down" not in prompts[5], "an accepted step begins anew"


def test_a_bad_text_does_not_spoil_the_good_one_beside_it(server):
    result = run(server, template(1.0), labels="x = (", budget=Budget(steps=1))
    assert result.verified and result.params["labelling_code"] == SKILL.labelling_code
    assert "(plan_template alone)" in result.steps[0].note


def test_one_reply_without_tags_costs_one_text(server):
    result = run(server, template(1.0), labels="<no tags>", budget=Budget(steps=1))
    assert result.verified
    assert "labelling_code: the reply has no improved variable" in result.steps[0].note


def test_one_text_without_an_answer_costs_one_text(server):
    result = run(server, template(1.0), labels=Status(500), budget=Budget(steps=1))
    assert result.verified and "labelling_code: the model did not answer" in result.steps[0].note


@pytest.mark.parametrize(
    "reply",
    [
        f"<IMPROVED_VARIABLE>{template(1.0)}",
        f"<IMPROVED_VARIABLE>\n```python\n{template(1.0)}\n```\n</IMPROVED_VARIABLE>",
        f"Without tags: a < b\n```python\n{template(1.0)}\n```\nThat is all.",
    ],
)
def test_replies_that_can_be_read(server, reply):
    result = run(server, reply)
    assert result.verified and result.params["plan_template"] == template(1.0)


@pytest.mark.parametrize(
    "reply", ["<empty/>", "<IMPROVED_VARIABLE></IMPROVED_VARIABLE>", "<", "<>"]
)
def test_replies_that_cannot_cost_a_step_and_not_the_run(server, reply):
    result = run(server, reply, reply, reply, reply, template(1.0))
    assert result.verified and len(result.steps) == 5
    assert {t.reason for s in result.steps for t in s.tried} == {"it changes nothing"}


def test_a_batch_is_summed_up(server):
    cases = [Case(name) for name in "abcde"]
    start = Parameters(SKILL.with_parameters({"plan_template": template(0.5)}))

    class Plans(FakeLoss):
        """Every case has a plan of its own."""

        def __call__(self, params, case):
            from dataclasses import replace

            value = super().__call__(params, case)
            return replace(value, plan=f"{value.plan}\n# {case.task}")

    run(server, template(1.0), loss=Plans(), cases=cases, params=start)
    (prompt,) = proposals(server)
    assert prompt.count("feedback of the engine") == 3
    assert sum(f"The task: {c.task}\n" in prompt for c in cases) == 3
    assert len(server.requests) == 3 * 2 + 2


def test_cases_with_the_same_plan_are_one(server):
    run(server, template(1.0))
    assert len(server.requests) == 1 * 2 + 2
    server.requests = []
    run(server, template(1.0), params=Parameters(SKILL, trainable=("plan_template",)))
    assert len(server.requests) == 2


def test_no_text_is_judged_twice(server):
    loss = FakeLoss()
    result = run(server, *[template(s) for s in (0.4, 0.4, 0.7, 0.4, 0.7, 0.9)], loss=loss)
    assert len(loss.calls) == len(set(loss.calls)) == result.spent.loss_calls


def test_the_users_engine_is_put_back(server):
    import_textgrad()
    import textgrad as tg

    from vaso.modules.textgrad import DspyEngine

    mine = DspyEngine(server.lm())
    tg.set_backward_engine(mine)
    try:
        for reply in (template(1.0), Status(401)):
            run(server, reply)
            assert tg.SingletonBackwardEngine().get_engine() is mine
    finally:
        tg.SingletonBackwardEngine().set_engine(None, override=True)


def test_runs_in_several_threads(server):
    """The backward engine belongs to the process."""
    results = []

    def one():
        results.append(run(server, template(0.8), template(1.0)))

    threads = [threading.Thread(target=one) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 3 and all(r.safety >= 0.8 for r in results)
