import statistics

import pytest

from vaso.comparison import Row, Statistic
from vaso.comparison.statistic import summarize


def row(seed, **values):
    return Row(skill="drive", optimizer="x", seed=seed, **values)


def test_the_standard_deviation_is_that_of_a_sample():
    found = Statistic.of([1, 2, 4])
    assert found.mean == pytest.approx(7 / 3) and found.n == 3
    assert found.sd == pytest.approx(statistics.stdev([1, 2, 4]))


def test_of_one_value_there_is_no_standard_deviation_and_of_none_nothing():
    assert Statistic.of([0.5]) == Statistic(mean=0.5, sd=None, n=1)
    assert Statistic.of([None]) is None
    assert Statistic.of([None, 3]) == Statistic(mean=3, sd=None, n=1)


def test_runs_that_failed_or_were_interrupted_do_not_count_in_means():
    rows = [
        row(0, safety=1.0, verified=True, steps=2),
        row(1, safety=0.5, steps=4),
        row(2, safety=0.0, steps=100, error="no answer"),
        row(3, safety=0.0, steps=100, interrupted=True),
    ]
    found = summarize("x", rows)
    assert (found.runs, found.finished, found.verified, found.failed) == (4, 2, 1, 2)
    assert found.mean("safety") == 0.75 and found.sd("safety") == pytest.approx(0.5 / 2**0.5)
    assert found.mean("steps") == 3
    assert found.mean("tokens") is None and found.shown("tokens") == ("–", "")
    assert found.verified_unseen is None


def test_nothing_is_known_of_an_optimizer_that_always_fails():
    found = summarize("x", [row(0, error="no answer")])
    assert found.statistics == {} and found.shown("safety") == ("–", "")


def test_unseen_tasks_are_counted_apart():
    rows = [row(n, verified=True, safety_unseen=n / 2, verified_unseen=n == 2) for n in range(3)]
    found = summarize("x", rows)
    assert found.verified == 3 and found.verified_unseen == 1
    assert found.mean("safety_unseen") == 0.5
