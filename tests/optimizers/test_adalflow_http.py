"""``optimize --optimizer adalflow``, end to end: real HTTP, real AdalFlow, real verifier.

A server on 127.0.0.1 plays the model from a script. Whatever it answers, the final skill is
verified, or the best version so far is kept and the result says so.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from openai_server import Drop, Hang, OpenAIServer, Raw, Status, prompt_of
from replies import GOOD, RECKLESS, STOPS, wrapped

import vaso
from vaso.modules import SymbolicPlanner
from vaso.optimizers.adalflow import AutoDiff
from vaso.optimizers.budget import Budget
from vaso.skill_file import load_skill, load_tasks

PEOPLE_ONLY = """while True:
    if people_observed():
        stop()
    else:
        forward()
"""
FIRST_MOVES_THEN_STOPS = """while people_observed() or obstacle_observed():
    stop()
forward()
while True:
    stop()
"""
DRIVE = load_skill("drive", version="initial")
ONE_TASK = load_tasks("drive").seen[:1]
ESCAPED = Path(tempfile.gettempdir()) / f"vaso-escaped-{os.getpid()}"
BLIND = DRIVE.labelling_code.replace('yolo_listener("people")', "False")


def is_proposal(prompt):
    return "<proposed_variable>The proposed variable content" in prompt


class Model:
    """Answers a prompt by what it asks for: feedback, labelling code, or the next template."""

    def __init__(self, *templates, labelling=None, feedback="The loop ends; it must go on."):
        self.templates = list(templates)
        self.labelling = list(labelling or [])
        self.feedback = feedback

    def __call__(self, request):
        prompt = prompt_of(request)
        if not is_proposal(prompt):
            return self.feedback
        if "<NAME> labelling_code </NAME>" in prompt:
            return self.labelling.pop(0) if self.labelling else wrapped(DRIVE.labelling_code)
        return self.templates.pop(0) if len(self.templates) > 1 else self.templates[0]


def optimize(server, model, skill=DRIVE, *, lm=None, **options):
    server.default = model
    options.setdefault("budget", Budget(steps=4))
    options.setdefault("optimizer", "adalflow")
    return vaso.optimize(skill, lm=lm or server.lm(), **options)


def assert_really_verified(result):
    """With a fresh call of the verifier, and without trusting the result."""
    assert result.verified and result.safety == 1.0
    for task in load_tasks("drive").seen:
        assert vaso.verify(result.skill, SymbolicPlanner()(result.skill, task))


def assert_contract_is_kept(result, skill=DRIVE):
    """The rules that never change are the same, byte for byte."""
    before, after = skill.model_dump(), result.skill.model_dump()
    for part in ("global_rules", "local_rules", "assumptions", "name", "platform"):
        assert before[part] == after[part]
    assert repr(before["global_rules"]).encode() == repr(after["global_rules"]).encode()


def reasons(result):
    return " | ".join(t.reason for s in result.steps for t in s.tried)


def test_repairs_drive(server):
    result = optimize(server, Model(wrapped(GOOD)))
    assert_really_verified(result)
    assert_contract_is_kept(result)
    assert result.skill.plan_template == GOOD.strip()
    assert [s.accepted for s in result.steps] == [True]
    assert result.spent.lm_calls == len(server.requests) == 6  # 2 samples x 2 texts + 2 proposals
    assert result.spent.tokens > 0


def test_the_counterexample_reaches_feedback_and_proposal(server):
    optimize(server, Model(wrapped(GOOD)))
    feedback = [p for p in server.prompts if not is_proposal(p)]
    proposals = [p for p in server.prompts if is_proposal(p)]
    assert feedback and proposals
    for prompt in feedback + proposals:
        assert "F(!stop)" in prompt and "people_observed" in prompt
    assert all("The loop ends; it must go on." in p for p in proposals)
    assert all("G(people_observed -> X stop)" in p for p in proposals)


BAD = {
    "broken XML": "<response><proposed_variable>while True:\n    if speed() < 0.5 & ",
    "no tags": "You should wait instead of leaving the loop.",
    "empty": "",
    "blank proposal": wrapped("  \n"),
    "prose as proposal": wrapped("Never break out of the loop."),
    "the raw prompt back": wrapped("```\n") + wrapped(""),
    "not Python": wrapped(GOOD.replace(":\n", "\n", 1)),
    "undefined function": wrapped(GOOD.replace("stop()", "halt()")),
    "only stops": wrapped(STOPS),
    "hardly moves": wrapped(FIRST_MOVES_THEN_STOPS),
    "no check at all": wrapped(RECKLESS),
    "imports": wrapped(f"import os\nos.system('touch {ESCAPED}')\n" + GOOD),
    "endless without a command": wrapped("while True:\n    pass\n"),
    "special token": wrapped("# <|endoftext|>\n" + RECKLESS),
    "template braces": wrapped("x = '{{ 7 * 7 }} {% raw %}'\n" + RECKLESS),
    "HTTP 500": Status(500),
    "HTTP 429": Status(429),
    "not JSON": Raw(b"<html>gateway</html>"),
    "no choices": Raw(b'{"id": "x", "object": "chat.completion", "choices": []}'),
    "dropped": Drop(),
}


def test_every_bad_reply_then_a_good_one(server):
    """Model errors stand apart: several in a row would end the run."""
    texts = [reply for reply in BAD.values() if isinstance(reply, str)]
    errors = [reply for reply in BAD.values() if not isinstance(reply, str)]
    replies = [r for pair in zip(errors, texts, strict=False) for r in pair] + texts[len(errors) :]
    model = Model(*replies, wrapped(GOOD))
    result = optimize(server, model, tasks=ONE_TASK, budget=Budget(steps=20))
    assert_really_verified(result)
    assert_contract_is_kept(result)
    assert len(model.templates) == 1
    errors_told = [s.error for s in result.steps if s.error]
    assert len(errors_told) == len(errors) - 1  # a completion without choices is an empty reply
    assert all("does not answer" in error for error in errors_told)
    assert not ESCAPED.exists()


@pytest.mark.parametrize("name", BAD)
def test_nothing_but_bad_replies(server, name):
    few = AutoDiff(max_proposals=1)
    result = optimize(server, Model(BAD[name]), tasks=ONE_TASK, optimizer=few, budget=2)
    assert not result.verified and result.skill == DRIVE
    assert result.safety == result.safety_before == 0.75 and result.completion == 1.0
    assert result.stop_reason and "NOT verified" in result.summary()
    assert all(not s.accepted and (s.error or s.tried_count) for s in result.steps)
    assert_contract_is_kept(result)


def test_the_result_says_why(server):
    result = optimize(server, Model(wrapped(STOPS), wrapped(FIRST_MOVES_THEN_STOPS), wrapped(GOOD)))
    assert "forward is executed never" in reasons(result)
    assert "forward is executed for at most 1 periods" in reasons(result)
    assert result.verified


def test_labels_that_lie_are_turned_down(server):
    model = Model(wrapped(RECKLESS), labelling=[wrapped(BLIND)] * 9)
    result = optimize(server, model, budget=Budget(steps=1))
    assert not result.verified and result.skill == DRIVE
    assert "do not tell the truth about the robot: people_observed" in reasons(result)


def test_a_bad_text_does_not_spoil_the_good_one_beside_it(server):
    model = Model(wrapped(GOOD), labelling=[wrapped(BLIND)])
    result = optimize(server, model, budget=Budget(steps=1))
    assert_really_verified(result)
    assert result.skill.labelling_code == DRIVE.labelling_code
    assert "alone" in result.steps[0].note


def test_the_best_so_far_is_kept(server):
    start = DRIVE.with_parameters({"plan_template": RECKLESS})
    model = Model(wrapped(PEOPLE_ONLY), wrapped(STOPS), Status(500), wrapped(RECKLESS))
    result = optimize(server, model, start, budget=Budget(steps=3))
    assert not result.verified
    assert (result.safety_before, result.safety) == (0.5, 0.75)
    assert result.skill.plan_template == PEOPLE_ONLY.strip()
    assert "the best version so far is kept" in result.summary()
    assert "G(obstacle_observed -> X !forward)" in result.steps[-1].violated


def test_bad_feedback_is_no_obstacle(server):
    for feedback in ("", Status(500), Drop(), "<|endoftext|> {{ x }} & <"):
        result = optimize(server, Model(wrapped(GOOD), feedback=feedback), tasks=ONE_TASK)
        assert_really_verified(result)


def test_a_rate_limit_that_does_not_end(server):
    result = optimize(server, Status(429, "slow down"), tasks=ONE_TASK)
    assert not result.verified and "does not answer: slow down" in result.stop_reason


def test_a_server_that_is_not_there(server):
    url = server.url
    server._http.server_close()
    result = vaso.optimize(DRIVE, optimizer="adalflow", lm=OpenAIServer.lm(server), budget=9)
    assert not result.verified and result.skill == DRIVE
    assert "does not answer" in result.stop_reason and len(result.steps) == 3
    assert url and "connect" in result.stop_reason


def test_a_rejected_key_ends_the_run_at_once(server):
    result = optimize(server, Status(401, "bad key"))
    assert len(result.steps) == 1 and "bad key" in result.stop_reason


@pytest.mark.parametrize("limit", [1, 3, 4, 5, 7])
def test_the_budget_of_model_calls_is_kept(server, limit):
    result = optimize(server, Model(wrapped(STOPS)), budget=Budget(steps=9, lm_calls=limit))
    assert len(server.requests) == result.spent.lm_calls == limit
    assert f"{limit} lm calls" in result.stop_reason


def test_the_budget_of_tokens_is_kept(server):
    result = optimize(server, Model(wrapped(STOPS)), budget=Budget(steps=9, tokens=3000))
    assert "3000 tokens" in result.stop_reason
    assert 3000 <= result.spent.tokens < 3000 + 4000  # the last call may go over


def test_a_server_that_hangs_does_not_outlast_the_budget(server):
    result = optimize(server, Hang(30, "late"), budget=Budget(steps=9, seconds=3))
    assert "3 seconds" in result.stop_reason and result.spent.seconds < 15


def test_the_same_seed_asks_the_same(server):
    script = [wrapped(STOPS), "no tags", wrapped(RECKLESS), wrapped(GOOD)]
    optimize(server, Model(*script), seed=3)
    first, server.requests = server.prompts, []
    optimize(server, Model(*script), seed=3)
    assert server.prompts == first and len(first) > 6


def test_resume_asks_nothing_twice(server, tmp_path):
    script = [wrapped(RECKLESS)] * 5 + [wrapped(GOOD)]
    whole = optimize(server, Model(*script), seed=1)
    asked, server.requests = server.prompts, []
    model = Model(*script)
    optimize(server, model, seed=1, out=tmp_path, budget=Budget(steps=1))
    resumed = optimize(server, model, seed=1, out=tmp_path, resume=True, budget=Budget(steps=4))
    assert server.prompts == asked
    assert resumed.skill == whole.skill and resumed.verified
    assert resumed.spent.lm_calls == whole.spent.lm_calls == len(asked)


def test_nothing_leaks_to_the_terminal(server, capfd):
    optimize(server, Model(BAD["broken XML"], Status(500), wrapped(STOPS), wrapped(GOOD)))
    out, err = capfd.readouterr()
    assert out == "" and err == ""


def test_on_the_command_line(server, tmp_path):
    """A fresh process with an empty home: the skill is written, and nothing else anywhere."""
    server.default = Model(BAD["broken XML"], wrapped(GOOD))
    home, out = tmp_path / "home", tmp_path / "out"
    home.mkdir()
    vaso_command = [sys.executable, "-c", "from vaso.cli import main; main()"]
    options = ["--optimizer", "adalflow", "--lm", "openai/test", "--out", str(out)]
    done = subprocess.run(
        [*vaso_command, "optimize", "drive", *options],
        env={**os.environ, "HOME": str(home), "VASO_API_BASE": server.url},
        cwd=home,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "verified" in done.stdout.lower() and "Traceback" not in done.stderr
    assert load_skill(out / "SKILL.md").plan_template == GOOD.strip()
    assert {p.name for p in out.iterdir()} >= {"SKILL.md", "events.jsonl", "checkpoint.json"}
    assert not (home / ".adalflow").exists() and not (home / "logs").exists()
