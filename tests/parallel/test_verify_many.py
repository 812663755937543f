"""Batches: results as they come, whatever happens to workers."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from batches import BROKEN, FAULTY, GOOD, SLOW, descendants, eventually, workers

from vaso import Plan, Verdict, load_skill, verify, verify_many
from vaso.errors import FormulaError, SkillError, VasoError
from vaso.parallel.batch import _within
from vaso.plan import Budget

PLANS = [GOOD, FAULTY, BROKEN, GOOD + "# again\n"]
VERDICTS = ["pass", "fail", "unsupported", "pass"]


def told(data):
    """A result's data without what differs from run to run."""
    if isinstance(data, list):
        return [told(item) for item in data]
    if isinstance(data, dict):
        return {k: told(v) for k, v in data.items() if k not in ("seconds", "from_memo")}
    return data


@pytest.mark.parametrize("executor", ["processes", "serial"])
def test_the_same_as_one_after_the_other(drive, executor):
    found = verify_many(PLANS, drive, executor=executor, workers=2, memo=False).collect()
    alone = [verify(drive, plan, between=False) for plan in PLANS]
    assert [told(result.to_json()) for result in found] == [told(r.to_json()) for r in alone]
    assert [str(result.verdict) for result in found] == VERDICTS
    assert not descendants() or not workers()


def test_results_come_with_their_place_and_only_pass_is_true(drive):
    seen = []
    with verify_many(PLANS, drive, workers=2, memo=False, on_result=seen.append) as batch:
        assert len(batch) == 4 and not workers()
        for place, result in batch:
            assert result.verdict == VERDICTS[place]
            assert result.system is None
    assert sorted(found.index for found in seen) == [0, 1, 2, 3]
    assert [bool(f) for f in sorted(seen, key=lambda f: f.index)] == [True, False, False, True]
    assert not workers()


def test_pairs_of_skill_and_plan_and_files(drive, tmp_path):
    path = tmp_path / "plan.py"
    path.write_text(GOOD)
    square = load_skill("fly-in-square-shape-traj")
    items = [path, ("find-object", FAULTY), (square, Plan(source=square.plan_template))]
    items.append(tmp_path / "none.py")
    first, find, fly, missing = verify_many(items, "drive", executor="serial", memo=False).collect()
    assert first and fly and not find
    assert len(find.specs) == 4 and "target_observed" in find.specs[-1].formula
    assert missing.problem.kind == "input" and "none.py" in missing.problem.message
    assert missing.verdict is Verdict.UNSUPPORTED


def test_an_interrupted_plan_does_not_stop_the_others(drive):
    """A worker that is killed loses nothing: its plan is verified by another one."""
    batch = verify_many([SLOW, GOOD], drive, workers=1, memo=False, budget=Budget(states=300))
    killed = []

    def kill():
        assert eventually(workers)
        (worker,) = workers()
        # It has the first plan when its sandbox is there.
        assert eventually(lambda: descendants(worker))
        os.kill(worker, signal.SIGKILL)
        killed.append(worker)

    thread = threading.Thread(target=kill)
    thread.start()
    slow, good = batch.collect()
    thread.join()
    assert killed and good
    assert slow.verdict is Verdict.UNKNOWN and "bound of" in slow.problem.message


def test_a_plan_that_loses_two_workers_is_an_error_and_costs_no_other(drive):
    batch = verify_many([SLOW, GOOD, FAULTY], drive, workers=1, memo=False)
    over = threading.Event()

    def kill():
        for _ in range(2):
            eventually(lambda: any(descendants(worker) for worker in workers()))
            for worker in workers():
                os.kill(worker, signal.SIGKILL)
            eventually(lambda: not workers())
        over.set()

    thread = threading.Thread(target=kill)
    thread.start()
    slow, good, faulty = batch.collect()
    thread.join()
    assert good and faulty.verdict is Verdict.FAIL
    assert slow.verdict is Verdict.UNKNOWN and slow.problem.kind == "unknown"
    assert "two workers were lost" in slow.problem.message and "SIGKILL" in slow.problem.message
    assert [s.reason for s in slow.specs] == [slow.problem.message] * 4


def test_time_is_kept_by_killing(drive):
    bounds = Budget(states=10**6, seconds=100)
    start = time.monotonic()
    (slow,) = verify_many([SLOW], drive, memo=False, timeout=1, budget=bounds).collect()
    assert time.monotonic() - start < 30
    assert slow.verdict is Verdict.UNKNOWN and not workers()
    assert slow.problem.message == "time-out: the plan was not decided in 1 s"


def test_exploration_leaves_time_for_checking_unless_the_caller_sets_bounds():
    assert _within(None, 6).seconds == 2
    assert _within(None, 600) == _within(None, None) == Budget()
    assert _within(Budget(seconds=50), 6).seconds == 50


def test_closing_ends_every_process(drive):
    batch = verify_many([GOOD, SLOW, SLOW + "#\n"], drive, workers=2, memo=False)
    before = set(descendants())
    place, result = next(batch)
    assert (place, bool(result)) == (0, True)
    running = set(descendants()) - before
    assert len(running) >= 4, "workers, sandboxes and a model checker"
    start = time.monotonic()
    batch.close()
    assert time.monotonic() - start < 5
    assert not workers() and eventually(lambda: not running & set(descendants()))
    assert list(batch) == []
    left = batch.collect()
    assert left[0] and [r.problem.message[:9] for r in left[1:]] == ["cancelled"] * 2


@pytest.mark.parametrize("kind", ["event", "function"])
def test_cancelling(drive, kind):
    event = threading.Event()
    cancel = event if kind == "event" else event.is_set
    batch = verify_many([SLOW, GOOD], drive, workers=1, memo=False, cancel=cancel)
    threading.Timer(1.0, event.set).start()
    found = batch.collect()
    assert event.is_set() and not workers()
    assert [r.verdict for r in found] == [Verdict.UNKNOWN] * 2


SCRIPT = """
import sys
from vaso import verify_many
sys.path.insert(0, FOLDER)
from batches import SLOW
plans = [SLOW + f"# {i}\\n" for i in range(4)]
print("started", flush=True)
for _ in verify_many(plans, "drive", workers=2, memo=False):
    print("one", flush=True)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_an_interrupt_leaves_no_process(number, tmp_path):
    script = tmp_path / "script.py"  # without a guard for __main__
    script.write_text(f"FOLDER = {str(Path(__file__).parent)!r}\n{SCRIPT}")
    program = subprocess.Popen(
        [sys.executable, script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert program.stdout.readline() == "started\n"
    assert eventually(lambda: len(descendants(program.pid)) >= 4, 30)
    running = set(descendants(program.pid))
    program.send_signal(number)
    program.communicate(timeout=20)
    assert program.returncode != 0
    assert eventually(lambda: not any(os.path.exists(f"/proc/{pid}") for pid in running))


def test_wrong_arguments_are_said_at_once(drive):
    with pytest.raises(VasoError, match="no executor 'clouds'"):
        verify_many([GOOD], drive, executor="clouds")
    with pytest.raises(VasoError, match="0 workers"):
        verify_many([GOOD], drive, workers=0)
    with pytest.raises(VasoError, match="in 0 s"):
        verify_many([GOOD], drive, timeout=0)
    with pytest.raises(VasoError, match="the skill is missing"):
        verify_many([GOOD])
    with pytest.raises(SkillError):
        verify_many([GOOD], "no-such-skill")
    with pytest.raises(FormulaError):
        verify_many([GOOD], drive, specs=["G("])
    assert verify_many([], drive).collect() == []


def test_an_error_of_a_skill_is_in_the_results(drive):
    wrong = drive.model_copy(update={"assumptions": (drive.rules[0],)})
    (found,) = verify_many([GOOD], wrong, executor="serial", memo=False).collect()
    assert found.problem.kind == "input" and "assumption" in found.problem.message
    assert found.verdict is Verdict.UNSUPPORTED


def test_a_verifier_that_cannot_be_handed_over(drive):
    class Mine:
        name = "mine"

        def __init__(self):
            self.lock = threading.Lock()

        def check(self, system, formulas, *, timeout=60.0, counterexamples=True):
            raise AssertionError

    with pytest.raises(VasoError, match="another process") as caught:
        verify_many([GOOD], drive, verifier=Mine(), memo=False).collect()
    assert "serial" in caught.value.hint
    (found,) = verify_many([GOOD], drive, verifier=Mine(), memo=False, executor="serial").collect()
    assert found.verdict is Verdict.UNKNOWN and "AssertionError" in found.problem.message
