import pytest
from openai_server import Drop, Status, prompt_of

import vaso
from vaso.modules import Planner, SymbolicPlanner
from vaso.optimizers.budget import Budget
from vaso.skill_file import load_skill, load_tasks

DRIVE = load_skill("drive", version="initial")
TASKS = load_tasks("drive").seen[:2]
GOOD = DRIVE.plan_template.replace("break", "stop()")
STOPS = "while True:\n    stop()\n"


def reply(text):
    return f"[[ ## new_text ## ]]\n```python\n{text}\n```\n\n[[ ## completed ## ]]"


def optimize(server, script, **options):
    server.script, server.requests = list(script), []
    options.setdefault("lm", server.lm())
    options.setdefault("budget", Budget(steps=3))
    return vaso.optimize(DRIVE, TASKS, optimizer="loop", **options)


def assert_really_verified(result):
    assert result.verified and result.skill.global_rules == DRIVE.global_rules
    for task in TASKS:
        assert vaso.verify(result.skill, SymbolicPlanner()(result.skill, task))


def test_one_call_repairs_drive(server):
    result = optimize(server, [reply(GOOD)])
    assert_really_verified(result)
    assert result.spent.lm_calls == len(server.requests) == 1
    prompt = server.prompts[0]
    for part in ("F !stop", "G(people_observed -> X stop)", "break", "people_observed()"):
        assert part in prompt


def test_the_model_hears_what_was_turned_down(server):
    result = optimize(server, [reply(STOPS), reply("while True\n  x"), reply(GOOD)])
    assert_really_verified(result)
    assert "forward is executed never" in server.prompts[1]
    assert "is not Python" in server.prompts[2]


@pytest.mark.parametrize(
    "bad", ["", "I cannot help.", reply(""), reply(STOPS), GOOD[:20], Status(500), Drop()]
)
def test_bad_replies(server, bad):
    assert_really_verified(optimize(server, [bad, bad, reply(GOOD)]))
    result = optimize(server, [bad] * 20, budget=Budget(steps=2))
    assert not result.verified and result.skill == DRIVE and result.stop_reason


def test_bare_code_without_the_format_is_taken(server):
    assert_really_verified(optimize(server, [GOOD]))


@pytest.mark.parametrize("limit", [1, 2])
def test_the_budget_of_model_calls_is_kept(server, limit):
    result = optimize(server, [reply(STOPS)] * 9, budget=Budget(lm_calls=limit))
    assert len(server.requests) == result.spent.lm_calls == limit


def test_with_a_planner_that_is_a_model(server):
    """Plans come from the model too, are charged to the same account, and are never drawn twice."""

    def model(request):
        prompt = prompt_of(request)
        if "new_text" in prompt:
            return reply(GOOD)
        template = GOOD if "break" not in prompt else DRIVE.plan_template
        return f"[[ ## plan ## ]]\n```python\n{template}\n```\n\n[[ ## completed ## ]]"

    server.default = model
    result = optimize(server, [], planner=Planner())
    assert result.verified
    assert len(server.requests) == result.spent.lm_calls == 2 + 1 + 2


def test_a_planner_whose_model_is_down_is_told(server):
    server.default = Status(503, "overloaded")
    result = optimize(server, [], planner=Planner())
    assert not result.verified and "overloaded" in result.stop_reason
    assert result.skill == DRIVE


def test_candidates_are_asked_for_and_judged_together(server):
    """Both calls are under way at the same time; the better candidate is taken."""
    import threading

    both = threading.Barrier(2, timeout=20)
    replies = iter([reply(STOPS), reply(GOOD)])

    def model(request):
        both.wait()
        return next(replies)

    server.default = model
    result = optimize(server, [], candidates=2)
    assert_really_verified(result)
    assert len(result.steps) == 1 and len(server.requests) == 2
    assert "given up" in result.steps[0].tried[0].reason


def test_of_equally_good_candidates_one_is_taken(server):
    result = optimize(server, [reply(GOOD)] * 4, candidates=4)
    assert_really_verified(result)
    assert [t.reason for t in result.steps[0].tried] == [
        "another candidate of the same step is at least as good"
    ] * 3
    assert result.spent.loss_calls == 2 * len(TASKS), "equal texts are judged once"


def test_an_error_among_candidates_does_not_cost_the_others(server):
    result = optimize(server, [Status(500), reply(GOOD)], candidates=2)
    assert_really_verified(result)
    assert len(result.steps) == 1


@pytest.mark.parametrize(("optimizer", "count"), [("repair", 2), ("loop", 0), ("loop", -1)])
def test_candidates_that_make_no_sense(server, optimizer, count):
    from vaso.errors import OptimizerError

    with pytest.raises(OptimizerError, match="candidate"):
        vaso.optimize(DRIVE, TASKS, optimizer=optimizer, lm=server.lm(), candidates=count)
