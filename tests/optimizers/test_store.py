import json
import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from fakes import CASES, SKILL, FakeLoss, Scripted, run, template

from vaso.errors import OptimizerError
from vaso.optimizers.budget import Budget
from vaso.optimizers.parameters import Parameters
from vaso.optimizers.store import RunStore, write_atomically

STEPS = [[template(0.4), template(0.7)], [template(0.6)], [RuntimeError("boom")], [template(1.0)]]


def events(folder):
    lines = (folder / "events.jsonl").read_text().splitlines()
    return [json.loads(line) for line in lines]


def test_the_folder_of_a_run(tmp_path):
    result = run(STEPS, store=RunStore(tmp_path / "new" / "run"))
    folder = tmp_path / "new" / "run"
    assert {p.name for p in folder.iterdir()} == {
        "checkpoint.json",
        "events.jsonl",
        "SKILL.md",
        "result.json",
    }
    kinds = [e["kind"] for e in events(folder)]
    assert kinds[0] == "started" and kinds[-1] == "finished" and kinds.count("accepted") == 2
    saved = json.loads((folder / "result.json").read_text())
    assert saved["verified"] and saved["texts"] == dict(result.params)
    assert "score = 1.0" in (folder / "SKILL.md").read_text()


@pytest.mark.parametrize("done", [1, 2, 3])
def test_resume_goes_on_where_it_stopped(tmp_path, done):
    whole = run(STEPS)
    first = Scripted(STEPS)
    run(first, store=RunStore(tmp_path), budget=Budget(steps=done))
    second, loss = Scripted(STEPS), FakeLoss()
    resumed = run(second, loss, store=RunStore(tmp_path, resume=True), budget=Budget(steps=4))
    assert [s.step for s in second.states] == list(range(done + 1, 5))
    assert resumed.skill == whole.skill and resumed.verified
    assert [s.model_dump() for s in resumed.steps] == [s.model_dump() for s in whole.steps]
    assert resumed.safety_before == whole.safety_before == 0.5
    assert resumed.spent.steps == 4
    assert "resumed" in [e["kind"] for e in events(tmp_path)]


def test_a_step_draws_the_same_random_numbers_after_a_resume(tmp_path):
    def numbers(proposer):
        return [s.rng.random() for s in proposer.states]

    whole = Scripted([[template(0.1)]] * 3)
    run(whole, seed=7)
    first, second = Scripted([[template(0.1)]] * 3), Scripted([[template(0.1)]] * 3)
    run(first, seed=7, store=RunStore(tmp_path), budget=Budget(steps=1))
    run(second, seed=7, store=RunStore(tmp_path, resume=True))
    assert numbers(first) + numbers(second) == numbers(whole)
    assert len(set(numbers(whole))) == 3


def test_resume_of_a_finished_run_is_the_result(tmp_path):
    run(STEPS, store=RunStore(tmp_path))
    again = Scripted([])
    result = run(again, store=RunStore(tmp_path, resume=True), budget=Budget(steps=4))
    assert result.verified and again.states == [] and len(result.steps) == 4


def test_resume_without_a_checkpoint_starts(tmp_path):
    assert run(STEPS, store=RunStore(tmp_path, resume=True)).verified


def test_without_resume_a_run_starts_again(tmp_path):
    run(STEPS, store=RunStore(tmp_path))
    proposer = Scripted([[template(0.9)]])
    result = run(proposer, store=RunStore(tmp_path))
    assert len(result.steps) == 1 and result.safety == pytest.approx(0.9)


@pytest.mark.parametrize(
    "other",
    [
        {"skill": SKILL.with_parameters({"plan_template": template(0.3)})},
        {"cases": CASES[:1]},
        {"params": Parameters(SKILL, trainable=["plan_template"])},
    ],
)
def test_a_checkpoint_of_another_run_is_refused(tmp_path, other):
    run(STEPS, store=RunStore(tmp_path), budget=Budget(steps=1))
    with pytest.raises(OptimizerError, match="another run"):
        run(STEPS, store=RunStore(tmp_path, resume=True), **other)


@pytest.mark.parametrize("damage", ["", "{", '{"version": 1}', "\0\0", "[]"])
def test_a_damaged_checkpoint_is_refused(tmp_path, damage):
    (tmp_path / "checkpoint.json").write_text(damage)
    with pytest.raises(OptimizerError, match="damaged"):
        run(STEPS, store=RunStore(tmp_path, resume=True))


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OptimizerError, match="cannot be written"):
        RunStore(tmp_path / "file")


def test_a_folder_that_goes_away_does_not_end_the_run(tmp_path):
    store = RunStore(tmp_path / "run")
    seen = []

    def remove(event):
        seen.append(event)
        if event.kind == "step" and (tmp_path / "run").exists():
            for file in (tmp_path / "run").iterdir():
                file.unlink()
            (tmp_path / "run").rmdir()

    result = run(STEPS, store=store, on_event=remove)
    assert result.verified and result.out is None
    assert any("not written any more" in e.message for e in seen)


def test_writing_leaves_the_old_content_until_the_new_is_there(tmp_path, monkeypatch):
    path = tmp_path / "file"
    write_atomically(path, "old")

    def no_space(*args):
        raise OSError("no space left on device")

    monkeypatch.setattr(os, "fsync", no_space)
    with pytest.raises(OSError, match="no space"):
        write_atomically(path, "new")
    assert path.read_text() == "old"


def test_kill_9_in_the_middle_of_a_step_then_resume(tmp_path):
    """The process is killed while it evaluates the second step; the first is on disk."""
    here = Path(__file__).parent
    script = f"""
        import os, signal, sys
        sys.path.insert(0, {str(here)!r})
        from fakes import FakeLoss, Scripted, run, template
        from test_store import STEPS
        from vaso.optimizers.store import RunStore

        class Deadly(FakeLoss):
            def __call__(self, params, case):
                if params["plan_template"] == template(0.6):
                    os.kill(os.getpid(), signal.SIGKILL)
                return super().__call__(params, case)

        run(Scripted(STEPS), Deadly(), store=RunStore({str(tmp_path)!r}))
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], check=False)
    assert done.returncode == -signal.SIGKILL
    proposer = Scripted(STEPS)
    resumed = run(proposer, store=RunStore(tmp_path, resume=True))
    assert resumed.skill == run(STEPS).skill and resumed.verified
    assert [s.step for s in proposer.states] == [2, 3, 4]
