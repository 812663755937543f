"""gepa, simba and mipro, end to end: real HTTP, real frameworks, real verifier. A server on
127.0.0.1 plays the model from a script."""

import importlib.util
import logging
import sys
from collections import Counter

import dspy
import pytest
from openai_server import Hang, OpenAIServer, Status, prompt_of
from replies import GOOD, RECKLESS, STOPS
from rewrites import (
    BAD,
    DRIVE,
    NO_CODE,
    TWO_TASKS,
    WEAK,
    Model,
    counting,
    fenced,
    kind,
    marked,
    optimize,
    really_verified,
    reasons,
)

from vaso.modules import Planner, SymbolicPlanner
from vaso.optimizers.budget import Budget
from vaso.skill_file import load_skill, load_tasks

THERE = ["gepa", "simba", "mipro"] if importlib.util.find_spec("optuna") else ["gepa", "simba"]
pytestmark = pytest.mark.parametrize("optimizer", THERE)


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Files that a framework leaves behind would show up here."""
    home = tmp_path / "home"
    home.mkdir()
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.chdir(home)
    yield
    assert list(home.iterdir()) == []


def test_repairs_drive_whatever_comes_back_on_the_way(server, optimizer, monkeypatch, capfd):
    judged = counting(monkeypatch)
    result, model = optimize(server, optimizer, *BAD, fenced(GOOD), tasks=None)
    assert result.verified and result.skill.plan_template == GOOD.strip()
    assert really_verified(result.skill, load_tasks("drive").seen)
    assert result.skill.global_rules == DRIVE.global_rules
    assert result.skill.labelling_code == DRIVE.labelling_code
    assert len(model.texts) == 1 and len(model.asked["text"]) == len(BAD) + 1
    assert result.spent.lm_calls == len(server.requests)
    assert result.spent.loss_calls == len(judged) and set(judged.values()) == {1}
    assert capfd.readouterr() == ("", "")
    for reason in ("the text is empty", "not Python", "given up", "cannot reach"):
        assert reason in reasons(result)


def test_repairs_the_square(server, optimizer):
    square = "fly-in-square-shape-traj"
    start, tasks = load_skill(square, version="initial"), load_tasks(square).seen[:2]
    half = start.plan_template.replace("ver_speed, vert", "ver_speed, more, vert")
    good = load_skill(square).plan_template
    result, _ = optimize(server, optimizer, half, fenced(good), skill=start, tasks=tasks)
    assert result.verified and really_verified(result.skill, tasks)


def test_the_prompt_says_what_is_needed(server, optimizer):
    _, model = optimize(server, optimizer, fenced(RECKLESS), fenced(GOOD))
    first, second = model.asked["text"][:2]
    for told in (
        "A Python program that shows a planner how the skill is executed safely",
        DRIVE.plan_template,
        DRIVE.labelling_code,
        "G(obstacle_observed -> X !forward)",
        "line 3 `break` leaves the loop",
    ):
        assert told.strip() in first
    assert f"{RECKLESS.strip()}\n-> safety would fall" in second


def test_goes_on_from_what_was_accepted(server, optimizer):
    start = DRIVE.with_parameters({"plan_template": RECKLESS})
    better = (
        "while True:\n    if people_observed():\n        stop()\n    else:\n        forward()\n"
    )
    result, model = optimize(server, optimizer, fenced(better), fenced(GOOD), skill=start)
    assert [s.safety for s in result.steps] == [0.75, 1.0] and result.safety_before == 0.5
    assert better.strip() in model.asked["text"][1] and result.skill.plan_template == GOOD.strip()


def test_a_skill_that_only_stops_is_no_end(server, optimizer):
    result, model = optimize(server, optimizer, fenced(STOPS), fenced(RECKLESS), fenced(GOOD))
    assert result.verified and len(result.steps) == 3 and len(model.asked["text"]) == 3


def test_a_model_that_never_says_anything_new_ends_the_run(server, optimizer):
    for reply in (NO_CODE, fenced(DRIVE.plan_template)):
        result, _ = optimize(server, optimizer, reply, budget=Budget(steps=9))
        assert not result.verified and result.skill == DRIVE and len(result.steps) <= 1
        assert "nothing new to propose" in result.stop_reason


def test_a_server_that_fails_for_good_keeps_the_first_version(server, optimizer, capfd):
    for failure in (Status(500, "broken"), Status(429, "slow down")):
        result, _ = optimize(server, optimizer, failure, budget=Budget(steps=9))
        assert result.skill == DRIVE and "3 times in a row" in result.stop_reason
        assert failure.message in result.stop_reason and failure.message in result.error
    assert capfd.readouterr() == ("", "")


def test_a_rejected_key_ends_the_run_at_once(server, optimizer, capfd):
    result, _ = optimize(server, optimizer, Status(401, "bad key"))
    assert "bad key" in result.stop_reason and len(server.requests) == 1
    assert result.skill == DRIVE and capfd.readouterr() == ("", "")


@pytest.mark.parametrize("limit", [1, 6])
def test_the_budget_of_model_calls_is_kept(server, optimizer, limit):
    result, _ = optimize(server, optimizer, *WEAK, budget=Budget(lm_calls=limit))
    assert len(server.requests) == result.spent.lm_calls == limit
    assert result.stop_reason == f"the budget of {limit} lm calls is spent"
    if limit == 1:
        assert len(result.steps) == 1, "what was paid for is judged"


def test_the_budgets_of_steps_and_loss_calls_are_kept(server, optimizer):
    result, model = optimize(server, optimizer, *WEAK, budget=Budget(steps=4))
    assert len(result.steps) == result.spent.steps == 4 == len(model.asked["text"])
    assert result.stop_reason == "the budget of 4 steps is spent"
    result, _ = optimize(server, optimizer, *WEAK, tasks=None, budget=Budget(loss_calls=8))
    assert result.spent.loss_calls == 8 and "8 loss calls" in result.stop_reason


def test_a_server_that_hangs_does_not_outlast_the_budget(server, optimizer):
    result, _ = optimize(server, optimizer, Hang(30, "late"), budget=Budget(seconds=1))
    assert "1 seconds" in result.stop_reason and result.spent.seconds < 8


def test_leaves_the_process_as_it_was(server, optimizer):
    log = logging.getLogger("dspy")
    before = sys.stdout, sys.stderr, list(log.handlers), log.propagate, log.level
    with dspy.context(lm=None, trace=[]):
        optimize(server, optimizer, fenced(RECKLESS), fenced(GOOD))
        assert dspy.settings.lm is None and dspy.settings.trace == []
    assert (sys.stdout, sys.stderr, list(log.handlers), log.propagate, log.level) == before


def test_what_the_user_shows_is_shown(server, optimizer, capfd):
    def planner(skill, task):
        print("drawing")
        return SymbolicPlanner()(skill, task)

    result, _ = optimize(
        server, optimizer, fenced(GOOD), planner=planner, on_event=lambda event: print(event.kind)
    )
    shown = capfd.readouterr().out.split()
    assert result.verified and shown[:2] == ["started", "drawing"] and shown[-1] == "finished"
    assert {"step", "proposed", "accepted"} <= set(shown) and shown.count("drawing") == 2


def test_plans_are_written_by_the_planners_model(server, optimizer):
    with OpenAIServer(default=marked(plan=GOOD)) as planning:
        planning.script = [marked(plan=RECKLESS)]
        start = DRIVE.with_parameters({"plan_template": RECKLESS})
        result, model = optimize(
            server,
            optimizer,
            fenced(GOOD),
            skill=start,
            planner=Planner(),
            planner_lm=planning.lm(),
        )
    assert result.verified and len(model.asked["text"]) == 1
    assert [kind(prompt) for prompt in planning.prompts] == ["plan", "plan"]


def test_a_model_that_can_follow_a_grammar_is_told_which(server, optimizer):
    grammars = []

    class Grammatical(dspy.LM):
        follows_grammar = False

        def with_grammar(self, gbnf):
            grammars.append(gbnf)
            tied = self.copy()
            tied.follows_grammar = True
            return tied

    lm = Grammatical("openai/test", api_base=server.url, api_key="none", cache=False)
    result, _ = optimize(server, optimizer, GOOD, lm=lm)
    assert result.verified and len(grammars) == 1 and '"forward()"' in grammars[0]


def test_a_planner_whose_model_fails(server, optimizer):
    """That is not the candidate's fault: it costs a step, and the run goes on."""
    plans = [marked(plan=RECKLESS), Status(500, "no plan now"), marked(plan=GOOD)]
    model = Model([fenced(GOOD)])

    def answer(request):
        writes_a_plan = kind(prompt_of(request)) == "plan"
        return plans.pop(0) if writes_a_plan else model(request)

    start = DRIVE.with_parameters({"plan_template": RECKLESS})
    result, _ = optimize(
        server, optimizer, model=answer, skill=start, planner=Planner(), budget=Budget(steps=4)
    )
    assert "no plan now" in result.steps[0].error and result.steps[0].tried_count == 0
    assert result.verified and len(result.steps) == 2 and plans == []


def test_resume_asks_nothing_twice(server, optimizer, tmp_path):
    """Later than the first proposals: advice and instructions have been asked for."""
    texts, common = [*WEAK, fenced(GOOD)], {"seed": 5, "tasks": TWO_TASKS}
    whole, model = optimize(server, optimizer, *texts, **common)
    assert optimizer == "gepa" or model.asked["advice"] or model.asked["instruction"]
    asked = Counter(server.prompts)
    assert whole.verified and whole.spent.lm_calls == asked.total() >= 10
    server.requests.clear()
    model = Model(list(texts))
    for calls in (8, 999):
        resumed, _ = optimize(
            server,
            optimizer,
            model=model,
            out=tmp_path / "out",
            resume=True,
            budget=Budget(steps=30, lm_calls=calls),
            **common,
        )
    assert Counter(server.prompts) == asked
    assert resumed.skill == whole.skill and resumed.verified
    for kept in ("steps", "loss_calls", "lm_calls", "prompt_tokens", "completion_tokens"):
        assert getattr(resumed.spent, kept) == getattr(whole.spent, kept), kept
