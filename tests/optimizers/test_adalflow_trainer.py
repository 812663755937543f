"""``adalflow-trainer``, with a loss that reads its values from the text."""

import pytest
from fakes import CASES, SKILL, FakeLoss, template
from openai_server import Status, prompt_of
from replies import wrapped

from vaso.optimizers import get_optimizer
from vaso.optimizers.adalflow_setup import import_adalflow
from vaso.optimizers.adalflow_trainer import AdalFlowTrainer
from vaso.optimizers.base import Case
from vaso.optimizers.budget import Budget
from vaso.optimizers.parameters import Parameters

PROPOSAL = "<proposed_variable>The proposed"
LABELS = "<NAME> labelling_code"
MANY = [Case(name) for name in "abcdefg"]


def run(server, *replies, optimizer=None, loss=None, start=0.5, **options):
    """Replies are the proposals for the template, put into AdalFlow's format unless they are."""
    templates = list(replies)

    def answer(request):
        prompt = prompt_of(request)
        if PROPOSAL not in prompt:
            return "feedback of the engine"
        if LABELS in prompt:
            return wrapped(SKILL.labelling_code)
        reply = templates.pop(0) if len(templates) > 1 else templates[0]
        return wrapped(reply) if isinstance(reply, str) and "<" not in reply else reply

    server.default = answer
    options.setdefault("budget", Budget(steps=max(1, len(replies))))
    skill = SKILL.with_parameters({"plan_template": template(start)})
    cases = options.pop("cases", CASES)
    chosen = get_optimizer(optimizer or AdalFlowTrainer())
    return chosen.optimize(Parameters(skill), loss or FakeLoss(), cases, lm=server.lm(), **options)


def proposals(server):
    return [p for p in server.prompts if PROPOSAL in p and LABELS not in p]


def feedback(server):
    return [p for p in server.prompts if PROPOSAL not in p]


def test_its_settings_are_adalflow_s_defaults():
    from inspect import signature

    import_adalflow()
    import adalflow as adal

    defaults = signature(adal.Trainer.__init__).parameters
    driver = get_optimizer("adalflow-trainer").driver
    for name in (
        "strategy",
        "train_batch_size",
        "num_workers",
        "max_proposals_per_step",
        "max_error_samples",
        "max_correct_samples",
        "max_steps",
    ):
        assert getattr(driver, name) == defaults[name].default


def test_proposals_are_accepted_or_rejected_until_all_is_verified(server):
    result = run(server, template(0.4), template(0.7), template(0.6), template(1.0))
    assert [s.accepted for s in result.steps] == [False, True, False, True] and result.verified
    assert result.stop_reason == "every task is verified"
    for prompt, best in zip(proposals(server), (0.5, 0.5, 0.7, 0.7), strict=True):
        assert f"<VARIABLE>score = {best}</VARIABLE>" in prompt


def test_five_proposals_a_batch_then_a_new_backward_pass(server):
    """AdalFlow keeps the feedback to a question, and does not pay for the same again."""
    tries = [template(0.1, number=n) for n in range(6)]
    run(server, *tries, template(1.0))
    asked = ["proposal" if PROPOSAL in p else "feedback" for p in server.prompts]
    assert asked == ["feedback"] * 4 + ["proposal"] * 14
    last = proposals(server)
    assert last[4].count("method: rewrite") == 4, "what failed on the same feedback"
    assert last[5].count("method: rewrite") == 0 and "1 steps since your last" in last[5]
    assert "feedback of the engine" in last[5]


def test_what_was_best_is_history(server):
    run(server, template(0.6), template(0.7), template(0.8), template(1.0))
    last = proposals(server)[-1]
    assert all(f"score = {s}" in last for s in (0.6, 0.7, 0.8)) and "eval_score: 0.8" in last


def test_at_most_two_failing_and_two_other_cases_are_sampled(server):
    run(server, template(1.0), cases=MANY)
    assert len(feedback(server)) == 2 * 2, "errors: none scores above 0.5"
    server.requests = []
    run(server, template(1.0), cases=MANY, start=0.7)
    assert len(feedback(server)) == 2 * 2, "AdalFlow counts these as correct"
    server.requests = []
    start = "score = 0.5\na = 0.7\nb = 0.7\nc = 0.7\nd = 0.7\ne = 0.7"
    skill = SKILL.with_parameters({"plan_template": start})
    options = {"lm": server.lm(), "budget": Budget(steps=1)}
    get_optimizer("adalflow-trainer").optimize(Parameters(skill), FakeLoss(), MANY, **options)
    assert 2 * 2 < len(feedback(server)) <= 4 * 2


def test_a_plan_that_does_more_of_its_task_is_kept_though_it_is_no_safer(server):
    """AdalFlow goes by safety alone, and goes on from what the session has kept."""
    loss = FakeLoss()
    poor = template(0.5, completion=0.5)
    skill = SKILL.with_parameters({"plan_template": poor})
    tries = [template(0.5, completion=0.8), template(1.0, completion=0.8)]
    server.default = lambda request: (
        "feedback"
        if PROPOSAL not in prompt_of(request)
        else wrapped(SKILL.labelling_code if LABELS in prompt_of(request) else tries.pop(0))
    )
    result = get_optimizer("adalflow-trainer").optimize(
        Parameters(skill), loss, CASES, lm=server.lm(), budget=Budget(steps=5)
    )
    assert [s.accepted for s in result.steps] == [True, True] and result.verified
    assert "completion = 0.8" in proposals(server)[1]


def test_the_session_s_verdict_is_the_trainer_s(server):
    """Safer on the whole and worse on one task: the mean decides, for both."""
    result = run(server, template(0.9, second=0.4), template(0.7, second=0.75), template(1.0))
    assert [round(s.safety, 3) for s in result.steps] == [0.65, 0.725, 1.0]
    result = run(server, template(0.9, completion=0.5), template(0.7), template(1.0))
    assert [s.accepted for s in result.steps] == [False, True, True]
    assert "completion would be given up" in result.steps[0].tried[0].reason


def test_no_text_is_judged_twice(server):
    loss = FakeLoss()
    tries = [template(s) for s in (0.4, 0.4, 0.7, 0.4, 0.7, 0.9)]
    result = run(server, *tries, loss=loss, cases=MANY)
    assert len(loss.calls) == len(set(loss.calls)) == result.spent.loss_calls


@pytest.mark.parametrize("bad", ["<response><proposed_variable>", Status(500)])
def test_replies_without_a_proposal(server, bad):
    result = run(server, bad, bad, template(1.0), budget=Budget(steps=9))
    assert result.verified
    assert [s.error != "" for s in result.steps][:-1] == [True, True] * isinstance(bad, Status)


def test_a_rate_limit_in_the_backward_pass_is_survived(server):
    """AdalFlow makes an exception of its own of it, which ends its training."""
    server.script = [Status(429, "slow down")]
    result = run(server, template(1.0), budget=Budget(steps=5))
    assert result.verified and "slow down" in result.steps[0].error


def test_a_model_that_repeats_itself_ends_the_run(server):
    result = run(server, template(0.4), budget=Budget(steps=9))
    assert not result.verified and "nothing new to propose" in result.stop_reason


def test_the_trainer_s_own_end(server):
    short = AdalFlowTrainer(max_steps=1, max_proposals_per_step=2)
    tries = [template(0.1, number=n) for n in range(5)]
    result = run(server, *tries, optimizer=short, budget=Budget(steps=9))
    assert len(result.steps) == 2 and "nothing more to propose" in result.stop_reason


def test_the_random_strategy(server):
    result = run(server, template(0.7), template(1.0), optimizer=AdalFlowTrainer(strategy="random"))
    assert result.verified and len(result.steps) == 2


def test_a_loss_that_crashes_costs_a_step(server):
    result = run(server, template(0.7, crash=1), template(1.0))
    assert result.verified and "cannot be evaluated" in result.steps[0].tried[0].reason


def test_a_run_in_a_thread(server):
    import threading

    results = []
    threads = [
        threading.Thread(target=lambda: results.append(run(server, template(0.8), template(1.0))))
        for _ in range(3)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 3 and all(r.safety >= 0.8 for r in results)
