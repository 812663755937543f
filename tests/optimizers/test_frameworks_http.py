"""``--optimizer textgrad`` and ``adalflow-trainer``, end to end: real HTTP, real frameworks, real
verifier. A server on 127.0.0.1 plays the model from a script.
"""

import importlib.util
import os
import random
import subprocess
import sys
import threading
from collections import Counter

import numpy as np
import pytest
from openai_server import Drop, Hang, Raw, Status
from replies import GOOD, RECKLESS, STOPS, Model

import vaso
from vaso.errors import MissingDependencyError
from vaso.modules import SymbolicPlanner
from vaso.optimizers import get_optimizer
from vaso.optimizers.budget import Budget
from vaso.optimizers.loss import SkillLoss
from vaso.skill_file import load_skill, load_tasks

pytestmark = pytest.mark.parametrize("optimizer", ["textgrad", "adalflow-trainer"])

DRIVE = load_skill("drive", version="initial")
ONE_TASK = load_tasks("drive").seen[:1]
NO_TAGS = "You should wait instead of leaving the loop."
BROKEN = "<response><proposed_variable>while a < b & c:\n    <IMPROVED_VARIABLE"
RAW = (NO_TAGS, BROKEN, "")
BAD = [
    Status(500),
    NO_TAGS,
    Drop(),
    BROKEN,
    Raw(b"<html>gateway</html>"),
    "",
    STOPS,
    GOOD.replace(":\n", "\n", 1),
    "import os\n" + RECKLESS,
    "x = '{{ 7 * 7 }} {% raw %} {0} {y}'  # a < b && <|endoftext|>\n" + RECKLESS,
]


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Files that a framework leaves behind would show up here."""
    (tmp_path / "home").mkdir()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path / "home")
    return tmp_path / "home"


def optimize(server, optimizer, *templates, skill=DRIVE, raw=RAW, feedback=None, **options):
    model = Model(optimizer, list(templates), skill.labelling_code, raw)
    model.feedback = model.feedback if feedback is None else feedback
    server.default = model
    options.setdefault("budget", Budget(steps=30))
    options.setdefault("tasks", ONE_TASK)
    return vaso.optimize(skill, optimizer=optimizer, lm=server.lm(), **options), model


def verified_by_a_fresh_call(skill, tasks):
    return all(vaso.verify(skill, SymbolicPlanner()(skill, task)) for task in tasks)


def test_repairs_drive_whatever_comes_back_on_the_way(server, optimizer, monkeypatch, capfd):
    judged = Counter()
    value = SkillLoss._value
    counting = lambda self, params, case, plan: (  # noqa: E731
        judged.update([(params.key, case)]) or value(self, params, case, plan)
    )
    monkeypatch.setattr(SkillLoss, "_value", counting)
    tasks = load_tasks("drive").seen[:3]
    result, model = optimize(server, optimizer, *BAD, GOOD, tasks=tasks)
    assert result.verified and result.skill.plan_template == GOOD.strip()
    assert verified_by_a_fresh_call(result.skill, tasks)
    assert result.skill.global_rules == DRIVE.global_rules
    assert len(model.templates) == 1 and len(model.proposals) == len(BAD) + 1
    assert result.spent.lm_calls == len(server.requests)
    assert set(judged.values()) == {1}, "no texts are judged twice on a task"
    assert capfd.readouterr() == ("", "")


def test_repairs_the_square(server, optimizer):
    square, tasks = "fly-in-square-shape-traj", load_tasks("fly-in-square-shape-traj").seen[:2]
    start = load_skill(square, version="initial")
    good = load_skill(square).plan_template
    result, _ = optimize(
        server, optimizer, NO_TAGS, start.plan_template, good, skill=start, tasks=tasks
    )
    assert result.verified and verified_by_a_fresh_call(result.skill, tasks)


def test_the_counterexample_reaches_every_prompt(server, optimizer):
    optimize(server, optimizer, GOOD)
    assert len(server.prompts) == 4  # feedback on two texts, a proposal for each
    for prompt in server.prompts:
        assert "F(!people_observed & !obstacle_observed) -> F !stop" in prompt
        assert "line 3 `break` leaves the loop" in prompt


def test_feedback_that_fails_is_no_obstacle(server, optimizer):
    result, _ = optimize(server, optimizer, GOOD, feedback="<|endoftext|> {{ x }} {0} & <")
    assert result.verified


def test_nothing_but_failures_keeps_the_first_version(server, optimizer):
    result, _ = optimize(server, optimizer, Drop(), feedback=Status(500), budget=9)
    assert not result.verified and result.skill == DRIVE and result.safety == 0.75
    assert "does not answer" in result.stop_reason and len(result.steps) == 3


def test_a_rejected_key_ends_the_run_at_once(server, optimizer):
    server.default = Status(401, "bad key")
    result = vaso.optimize(DRIVE, ONE_TASK, optimizer=optimizer, lm=server.lm())
    assert len(server.requests) == 1 and "bad key" in result.stop_reason


@pytest.mark.parametrize("limit", [1, 4])
def test_the_budget_of_model_calls_is_kept(server, optimizer, limit):
    result, _ = optimize(server, optimizer, STOPS, RECKLESS, NO_TAGS, budget={"lm_calls": limit})
    assert len(server.requests) == result.spent.lm_calls == limit
    assert f"{limit} lm calls" in result.stop_reason


def test_a_server_that_hangs_does_not_outlast_the_budget(server, optimizer):
    server.default = Hang(30, "late")
    budget = Budget(seconds=1)
    result = vaso.optimize(DRIVE, ONE_TASK, optimizer=optimizer, lm=server.lm(), budget=budget)
    assert "1 seconds" in result.stop_reason and result.spent.seconds < 10


SCRIPT = [STOPS, NO_TAGS, GOOD]


def test_the_same_seed_asks_the_same(server, optimizer):
    prompts = []
    for disturbance in (1, 2):
        random.seed(disturbance)
        np.random.seed(disturbance)
        server.requests = []
        optimize(server, optimizer, *SCRIPT, tasks=load_tasks("drive").seen[:3], seed=3)
        prompts.append(server.prompts)
    assert prompts[0] == prompts[1] and len(prompts[0]) >= 8


@pytest.mark.parametrize("cut", [5])
def test_resume_after_any_question_repeats_none(server, optimizer, cut, tmp_path):
    whole, _ = optimize(server, optimizer, *SCRIPT, seed=1)
    asked, server.requests = server.prompts, []
    options = {"seed": 1, "out": tmp_path / "out"}
    optimize(server, optimizer, *SCRIPT, budget={"lm_calls": cut}, **options)
    assert len(server.requests) == cut
    options |= {"lm": server.lm(), "optimizer": optimizer, "tasks": ONE_TASK}
    resumed = vaso.optimize(DRIVE, resume=True, budget=Budget(steps=30), **options)
    assert Counter(server.prompts) == Counter(asked)
    assert resumed.skill == whole.skill and resumed.verified
    assert resumed.spent.lm_calls == whole.spent.lm_calls == len(asked)


def test_the_user_s_process_is_as_before(server, optimizer, elsewhere, capfd):
    random.seed(5)
    np.random.seed(5)
    before = random.getstate(), np.random.get_state()[1].tolist(), dict(os.environ)
    result, _ = optimize(server, optimizer, NO_TAGS, GOOD, on_event=lambda e: print(e.kind))
    assert result.verified
    assert capfd.readouterr().out.split()[-3:] == ["accepted", "evaluated", "finished"]
    assert before == (random.getstate(), np.random.get_state()[1].tolist(), dict(os.environ))
    assert list(elsewhere.iterdir()) == []


def test_without_the_package(optimizer, monkeypatch):
    assert get_optimizer(optimizer).name == optimizer and get_optimizer(optimizer).needs_lm
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(MissingDependencyError, match=optimizer.split("-")[0]):
        get_optimizer(optimizer)


KILLED = """
import sys, vaso
from vaso.skill_file import load_tasks
optimizer, out, resume = sys.argv[1:]
tasks, lm = load_tasks("drive").seen[:2], "openai/test"
result = vaso.optimize(
    "drive", tasks, optimizer=optimizer, lm=lm, out=out, resume=resume == "resume", budget=30
)
print(result.verified, result.spent.lm_calls, result.skill.plan_template)
"""


@pytest.mark.slow
@pytest.mark.parametrize("questions", [5])
def test_kill_9_and_resume(server, optimizer, questions, tmp_path):
    def start(out, resume="no"):
        variables = {"VASO_API_BASE": server.url, "DSPY_CACHEDIR": str(tmp_path / f"{out}-cache")}
        command = [sys.executable, "-c", KILLED, optimizer, str(tmp_path / out), resume]
        env = {**os.environ, **variables}
        return subprocess.Popen(command, env=env, stdout=subprocess.PIPE, text=True)

    server.default = Model(optimizer, list(SCRIPT), DRIVE.labelling_code, RAW)
    whole = start("whole").communicate()[0]
    asked, server.requests = server.prompts, []

    model, hangs = Model(optimizer, list(SCRIPT), DRIVE.labelling_code, RAW), threading.Event()

    def answer(request):
        if len(server.requests) == questions + 1 and not hangs.is_set():
            hangs.set()
            return Hang(60)
        return model(request)

    server.default = answer
    killed = start("killed")
    assert hangs.wait(60)
    killed.kill()
    killed.communicate()
    del server.requests[questions:]
    resumed = start("killed", "resume").communicate()[0]
    assert whole.startswith("True") and resumed == whole
    assert Counter(server.prompts) == Counter(asked)
