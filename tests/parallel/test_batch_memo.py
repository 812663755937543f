"""Batches and the memo."""

import pytest
from batches import BROKEN, FAULTY, GOOD, SLOW, workers

from vaso import Plan, verify_many
from vaso.plan import Budget


@pytest.mark.parametrize("executor", ["processes", "serial"])
def test_the_second_batch_starts_no_worker(drive, memo, executor):
    plans = [GOOD, FAULTY, BROKEN]
    first = verify_many(plans, drive, executor=executor, workers=2, memo=memo).collect()
    batch = verify_many(plans, drive, executor=executor, workers=2, memo=memo)
    assert [found.index for found in batch] == [0, 1, 2]
    again = batch.collect()
    assert not workers()
    assert again == first
    assert [r.from_memo for r in (*first, *again)] == [False] * 3 + [True] * 3


def test_executors_share_the_memo(drive, memo):
    verify_many([FAULTY], drive, executor="serial", memo=memo).collect()
    (found,) = verify_many([FAULTY], drive, memo=memo).collect()
    assert found.from_memo


def test_a_batch_that_was_given_up_keeps_what_it_found(drive, memo):
    with verify_many([FAULTY, SLOW], drive, workers=1, memo=memo) as batch:
        assert next(batch).index == 0
    assert verify_many([FAULTY], drive, memo=memo).collect()[0].from_memo


def test_the_same_plan_twice_is_verified_once(drive, memo):
    plans = [FAULTY, Plan(source=FAULTY, path="other.py"), FAULTY + "#\n"]
    found = verify_many(plans, drive, executor="serial", memo=memo).collect()
    assert [r.plan for r in found] == [FAULTY, FAULTY, FAULTY + "#\n"]
    seconds = [r.seconds for r in verify_many([FAULTY] * 3, drive, memo=memo).collect()]
    assert len(set(seconds)) == 1


def test_what_ran_out_of_time_is_tried_again(drive, memo):
    bounds = Budget(states=10**6, seconds=100)
    for _ in range(2):
        (found,) = verify_many([SLOW], drive, memo=memo, timeout=1, budget=bounds).collect()
        assert "time-out" in found.problem.message and not found.from_memo
    assert memo.info().entries == 0


def test_a_worker_that_runs_other_code_adds_nothing(drive, memo, monkeypatch):
    monkeypatch.setattr("vaso.parallel.scheduler.code_of", lambda greeting: "other code")
    assert verify_many([FAULTY], drive, workers=1, memo=memo).collect()[0].failures
    assert memo.info().entries == 0


def test_the_user_s_memo_can_be_turned_off(drive, tmp_path, monkeypatch):
    monkeypatch.setattr("vaso.memo.keys.code_digest", lambda: "the code")
    monkeypatch.setattr("vaso.parallel.run.code_digest", lambda: "the code")
    monkeypatch.setenv("VASO_CACHE", str(tmp_path))
    verify_many([FAULTY], drive, executor="serial", memo=False).collect()
    assert not list(tmp_path.rglob("*.memo"))
    verify_many([FAULTY], drive, executor="serial").collect()
    assert len(list(tmp_path.rglob("*.memo"))) == 1
