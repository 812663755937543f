"""Exploration and its sandbox share one core, and leave no trace of it."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Iterator

import pytest

from vaso.plan import affinity, compile_plan
from vaso.plan.affinity import OneCore, adopt
from vaso.plan.explore import Budget
from vaso.skill_file import load_skill

pytestmark = pytest.mark.skipif(
    not hasattr(os, "sched_setaffinity") or len(os.sched_getaffinity(0)) < 2,
    reason="needs Linux and two cores",
)

DRIVE = load_skill("drive")
LONG = "n = 0\nwhile n < 120:\n    forward() if people_observed() else stop()\n    n += 1\n"


@pytest.fixture(autouse=True)
def sandbox() -> None:
    """A pool of sandbox processes whose client threads are known."""
    compile_plan("stop()", DRIVE)


@pytest.fixture
def other() -> Iterator[int]:
    """A process that stands for one of the sandbox."""
    process = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    yield process.pid
    process.communicate(b"\n")


def everybody() -> list[set[int]]:
    """Where the threads of this process and its sandbox may run."""
    mine = [os.sched_getaffinity(t) for t in affinity._threads(os.getpid())]
    return [*mine, *(os.sched_getaffinity(t) for w in WORKERS for t in affinity._threads(w))]


WORKERS: set[int] = set()


@pytest.fixture(autouse=True)
def workers(monkeypatch: pytest.MonkeyPatch) -> None:
    WORKERS.clear()

    def note(worker: int) -> None:
        WORKERS.add(worker)
        adopt(worker)

    monkeypatch.setattr("vaso.plan.machine.adopt", note)


def test_while_exploring_all_are_on_one_core_and_afterwards_free_again() -> None:
    allowed = os.sched_getaffinity(0)
    seen: list[set[int]] = []

    def look(_: int) -> None:
        client = affinity._clients[os.getpid()]
        threads = [*client, *(t for w in WORKERS for t in affinity._threads(w))]
        seen.append(set().union(*(os.sched_getaffinity(t) for t in threads)))
        assert os.sched_getaffinity(0) == allowed  # what is started here inherits it

    compile_plan(LONG, DRIVE, on_states=look)
    assert seen and len(seen[0]) == 1
    assert all(cores == allowed for cores in everybody())


@pytest.mark.parametrize("text", ["boom(", "forward(speed=", "undefined_function()"])
def test_after_an_error_everybody_is_free_again(text: str) -> None:
    allowed = os.sched_getaffinity(0)
    with pytest.raises(Exception, match=r".+"):
        compile_plan(text, DRIVE)
    assert all(cores == allowed for cores in everybody())


def test_a_core_that_others_need_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    allowed = os.sched_getaffinity(0)
    with OneCore() as core:
        assert len(os.sched_getaffinity(0)) == 1
        monkeypatch.setattr(affinity, "_delay", lambda: core._looked[1] + 1e9)
        core._looked = (core._looked[0] - 1.0, core._looked[1])
        core.check()
        assert os.sched_getaffinity(0) == allowed
        core.check()
    assert os.sched_getaffinity(0) == allowed


def test_a_core_without_others_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    with OneCore() as core:
        monkeypatch.setattr(affinity, "_delay", lambda: core._looked[1])
        core._looked = (core._looked[0] - 1.0, core._looked[1])
        core.check()
        assert len(os.sched_getaffinity(0)) == 1


def test_nothing_is_done_where_nobody_tells_who_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    allowed = os.sched_getaffinity(0)
    monkeypatch.setattr(affinity, "_delay", lambda: None)
    with OneCore():
        assert os.sched_getaffinity(0) == allowed


def test_explorations_at_the_same_time_have_all_cores(other: int) -> None:
    allowed = os.sched_getaffinity(0)
    inside: list[set[int]] = []

    turn = threading.Event()

    def explore() -> None:
        turn.wait()
        with OneCore():
            inside.append(os.sched_getaffinity(0))

    thread = threading.Thread(target=explore)
    thread.start()
    with OneCore() as core:
        adopt(other)
        assert os.sched_getaffinity(other) == os.sched_getaffinity(0) != allowed
        turn.set()
        thread.join()
        assert inside == [allowed]
        assert os.sched_getaffinity(0) == os.sched_getaffinity(other) == allowed
        core.check()


def test_a_sandbox_process_of_another_thread_frees_all(other: int) -> None:
    allowed = os.sched_getaffinity(0)
    with OneCore():
        thread = threading.Thread(target=adopt, args=(other,))
        thread.start()
        thread.join()
        assert os.sched_getaffinity(0) == os.sched_getaffinity(other) == allowed


def test_who_has_one_core_only_keeps_it() -> None:
    allowed = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(allowed)})
        with OneCore():
            assert os.sched_getaffinity(0) == {min(allowed)}
        assert os.sched_getaffinity(0) == {min(allowed)}
    finally:
        os.sched_setaffinity(0, allowed)


def test_many_explorations_at_the_same_time_end_free_and_agree() -> None:
    allowed = os.sched_getaffinity(0)
    expected = compile_plan(LONG, DRIVE).transitions
    found: list[int] = []

    def explore() -> None:
        found.append(compile_plan(LONG, DRIVE, budget=Budget(seconds=60.0)).transitions)

    threads = [threading.Thread(target=explore) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected] * 4
    assert all(cores == allowed for cores in everybody())
