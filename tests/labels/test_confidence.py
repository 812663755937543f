import math

import pytest

from vaso.labels.confidence import upper_bound


def at_most(failures, trials, rate):
    return sum(
        math.comb(trials, k) * rate**k * (1 - rate) ** (trials - k) for k in range(failures + 1)
    )


@pytest.mark.parametrize("confidence", [0.95, 0.99])
@pytest.mark.parametrize(("failures", "trials"), [(0, 1), (0, 300), (1, 20), (7, 100), (99, 100)])
def test_at_the_bound_so_few_failures_are_just_too_unlikely(failures, trials, confidence):
    bound = upper_bound(failures, trials, confidence)
    assert at_most(failures, trials, bound) == pytest.approx(1 - confidence, rel=1e-6)


def test_the_rule_of_three():
    assert upper_bound(0, 1000, 0.95) == pytest.approx(3 / 1000, rel=0.01)


@pytest.mark.parametrize(("failures", "trials"), [(0, 0), (5, 5)])
def test_nothing_is_known(failures, trials):
    assert upper_bound(failures, trials, 0.95) == 1.0


def test_published_values():
    """Clopper & Pearson's one-sided 97.5 % bound for 10 of 100: 0.1762 (their figure 4)."""
    assert upper_bound(10, 100, 0.975) == pytest.approx(0.1762, abs=5e-5)
