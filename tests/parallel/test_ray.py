"""Batches on Ray."""

import os
import signal
import sys
import threading
from pathlib import Path

import pytest
from batches import BROKEN, FAULTY, GOOD, SLOW, descendants, eventually

from vaso import verify_many
from vaso.errors import MissingDependencyError, VasoError
from vaso.plan import Budget


def test_without_ray_it_says_what_to_install(drive, monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(MissingDependencyError, match="'ray' is not installed") as caught:
        verify_many([GOOD], drive, executor="ray")
    assert isinstance(caught.value, VasoError)
    assert "--extra ray" in caught.value.hint


def actors() -> list[int]:
    return [p for p, command in descendants().items() if command.startswith("ray::_Verifier")]


def sandboxes() -> list[int]:
    """Sandboxes of actors; this process has some of its own."""
    found = [p for p, command in descendants().items() if "monty" in command]
    return [p for p in found if parent(p) != os.getpid()]


def parent(pid: int) -> int:
    try:
        return int(Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1].split()[1])
    except OSError:
        return 0


@pytest.fixture(scope="module")
def ray():
    found = pytest.importorskip("ray")
    found.init(num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level="ERROR")
    yield found
    found.shutdown()


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_two_workers_give_what_one_process_gives(drive, ray):
    plans = [GOOD, FAULTY, BROKEN, GOOD + "#\n"]
    there = verify_many(plans, drive, executor="ray", workers=2, memo=False).collect()
    here = verify_many(plans, drive, executor="serial", memo=False).collect()
    assert [r.verdict for r in there] == [r.verdict for r in here]
    assert [r.problem for r in there] == [r.problem for r in here]
    assert [[s.counterexample for s in r.specs] for r in there] == [
        [s.counterexample for s in r.specs] for r in here
    ]
    assert eventually(lambda: not actors())


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_a_killed_worker_loses_nothing(drive, ray):
    batch = verify_many(
        [SLOW, GOOD, FAULTY], drive, executor="ray", workers=2, memo=False,
        budget=Budget(states=300), timeout=None,
    )  # fmt: skip

    def kill():
        assert eventually(sandboxes, 120)
        for actor in actors():
            os.kill(actor, signal.SIGKILL)

    thread = threading.Thread(target=kill)
    thread.start()
    slow, good, faulty = batch.collect()
    thread.join()
    assert [str(r.verdict) for r in (slow, good, faulty)] == ["unknown", "pass", "fail"]
    assert "bound of 300 states" in slow.problem.message


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_time_and_closing_end_actors(drive, ray):
    bounds = Budget(states=10**6, seconds=200)
    options = {"executor": "ray", "workers": 2, "memo": False, "budget": bounds, "timeout": 10}
    slow, good = verify_many([SLOW, GOOD], drive, **options).collect()
    assert "time-out" in slow.problem.message and good
    with verify_many([SLOW, GOOD], drive, **options) as batch:
        assert next(batch).index == 1
        assert sandboxes()
    assert eventually(lambda: not actors() and not sandboxes(), 60), descendants()
