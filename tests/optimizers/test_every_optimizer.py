"""What all optimizers promise, each over real HTTP: they arrive, whatever is answered on the way;
they keep budgets; they judge no text twice; and after a kill they go on without paying again."""

import os
import signal
import subprocess
import sys
import textwrap
from collections import Counter
from pathlib import Path

import pytest
from edit_server import MALFORMED, EditServer
from openai_server import Status

import vaso
from vaso.optimizers import Budget, SkillLoss, optimizers
from vaso.skill_file import load_skill, load_tasks

ASKING = [name for name in optimizers() if name != "repair"]
SKILLS = ["drive", "fly-in-square-shape-traj"]


def optimize(server, optimizer, skill="drive", **options):
    options.setdefault("budget", Budget(steps=60, seconds=100))
    options.setdefault("level", "repair")
    tasks = load_tasks(skill).seen[:2]
    lm = server.lm(temperature=1.0)
    return vaso.optimize(skill, tasks, optimizer=optimizer, lm=lm, **options)


@pytest.fixture
def judged(monkeypatch):
    """How often the verifier was asked about each plan under the same rules and labels."""
    counts = Counter()
    original = SkillLoss.__init__

    def init(self, *args, **options):
        original(self, *args, **options)
        verify = self._verify

        def counting(skill, plan):
            rules = tuple(r.text for r in (*skill.rules, *skill.assumptions))
            counts[rules, skill.labelling_code, plan.source] += 1
            return verify(skill, plan)

        self._verify = counting

    monkeypatch.setattr(SkillLoss, "__init__", init)
    return counts


@pytest.mark.parametrize("skill", SKILLS)
@pytest.mark.parametrize("optimizer", ASKING)
def test_arrives_in_spite_of_malformed_replies(optimizer, skill, judged, capfd):
    with EditServer(dict(enumerate(MALFORMED, start=1))) as server:
        result = optimize(server, optimizer, skill)
    assert result.verified, (result.stop_reason, [s.error for s in result.steps])
    start = load_skill(skill, version="initial")
    assert result.skill.global_rules == start.global_rules and result.initial_skill != result.skill
    for value in result.values.values():
        assert vaso.verify(result.skill, value.plan), "verified by a fresh check as well"
    assert set(judged.values()) == {1}, "no text is judged twice"
    assert result.spent.lm_calls >= len(server.requests) > 0
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("optimizer", ASKING)
@pytest.mark.parametrize("limit", ["lm_calls", "loss_calls"])
def test_budgets_are_kept(optimizer, limit):
    with EditServer() as server:
        result = optimize(server, optimizer, level="verdict", budget=Budget(steps=50, **{limit: 5}))
    assert getattr(result.spent, limit) <= 5 and result.stop_reason
    assert len(server.requests) <= result.spent.lm_calls
    assert result.verified or f"5 {limit.replace('_', ' ')}" in result.stop_reason


@pytest.mark.parametrize("optimizer", ASKING)
def test_a_wrong_key_ends_the_run_at_once(optimizer, capfd):
    with EditServer({n: Status(401, "this key is wrong") for n in range(1, 99)}) as server:
        result = optimize(server, optimizer)
    assert not result.verified and "this key is wrong" in result.stop_reason
    assert len(server.requests) <= 4, "a few that were under way at the same time"
    assert result.safety == result.safety_before > 0
    assert capfd.readouterr() == ("", "")


# -- kill -9 ---------------------------------------------------------------------------------------

RUN = """
import sys, dspy, vaso
from vaso.optimizers import Budget
from vaso.skill_file import load_tasks

if __name__ == "__main__":
    url, optimizer, out, resume, steps = sys.argv[1:]
    lm = dspy.LM("openai/test", api_base=url, api_key="none", cache=False, num_retries=0,
                 temperature=1.0)
    result = vaso.optimize("drive", load_tasks("drive").seen[:2], optimizer=optimizer, lm=lm,
                           out=out, resume=resume == "1", level="verdict",
                           budget=Budget(steps=int(steps)), seed=3)
    print(result.spent.lm_calls, result.spent.loss_calls)
"""


STEPS = {"adalflow": 1, "loop": 2}
"""Steps of a run, where one step is many candidates."""


def in_a_process(server, optimizer, out, *, resume=False):
    """Run; the server's faults may kill the process."""
    script = Path(out).parent / "run.py"
    script.write_text(textwrap.dedent(RUN))
    steps = STEPS.get(optimizer, 4)
    told = [server.url, optimizer, str(out), str(int(resume)), str(steps)]
    command = [sys.executable, str(script), *told]
    environment = {**os.environ, "PYTHONPATH": str(Path(vaso.__file__).parent.parent)}
    process = subprocess.Popen(
        command, env=environment, cwd=Path(out).parent, stdout=-1, stderr=-1, text=True
    )
    server.pid = process.pid
    try:
        output, errors = process.communicate(timeout=110)
    finally:
        process.kill()
    return process.returncode, output, errors


def kills(server):
    def fault(request):
        os.kill(server.pid, signal.SIGKILL)
        return Status(500)

    return fault


@pytest.mark.parametrize("optimizer", ASKING)
def test_killed_and_resumed_is_as_if_never_stopped(optimizer, tmp_path):
    folders = [tmp_path / name for name in ("whole", "killed")]
    for folder in folders:
        folder.mkdir()
    with EditServer() as server:
        code, whole, errors = in_a_process(server, optimizer, folders[0] / "run")
        assert code == 0, errors
        asked, expected = len(server.requests), server.answered
    assert asked >= 4, "there is something to kill"
    with EditServer() as server:
        server.faults = {asked // 2 + 1: kills(server)}
        code, _, _ = in_a_process(server, optimizer, folders[1] / "run")
        assert code == -signal.SIGKILL
        code, resumed, errors = in_a_process(server, optimizer, folders[1] / "run", resume=True)
        assert code == 0, errors
        assert server.answered == expected, "every question was answered as often as without a kill"
    assert resumed == whole
    skills = [(folder / "run" / "SKILL.md").read_text() for folder in folders]
    assert skills[0] == skills[1]
