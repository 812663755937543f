import copy

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vaso.errors import OptimizerError
from vaso.optimizers.budget import Budget, BudgetExhausted, Ledger, Spent


class Clock:
    now = 100.0

    def __call__(self):
        return self.now


def test_of_reads_what_users_write():
    assert Budget.of(None) == Budget() and Budget.of(3) == Budget(steps=3)
    assert Budget.of({"lm_calls": 5}) == Budget(lm_calls=5)
    assert Budget.of(Budget(tokens=1)) == Budget(tokens=1)


@pytest.mark.parametrize("bad", [{"stepz": 1}, {"steps": -1}, {"cost": True}])
def test_bad_budgets_are_refused(bad):
    with pytest.raises(OptimizerError):
        Budget.of(bad)


def test_tokens_and_cost_are_limits():
    ledger = Ledger(Budget(tokens=10, cost=0.5))
    ledger.charge(prompt_tokens=6)
    ledger.require()
    ledger.charge(completion_tokens=4)
    with pytest.raises(BudgetExhausted, match="10 tokens"):
        ledger.require()
    ledger.require("cost", "seconds")
    ledger.charge(cost=0.5)
    assert "0.5 cost" in (ledger.exhausted("cost") or "")


def test_time_goes_on_over_a_resume():
    clock = Clock()
    ledger = Ledger(Budget(seconds=5), spent=Spent(seconds=3, steps=2), clock=clock)
    assert ledger.seconds_left() == 2
    clock.now += 1.5
    assert ledger.spent.seconds == 4.5 and ledger.exhausted() is None
    clock.now += 1
    assert "5 seconds" in (ledger.exhausted() or "") and ledger.seconds_left() == 0


def test_a_copy_charges_the_same_account():
    ledger = Ledger(Budget(steps=1))
    copy.deepcopy(ledger).charge(steps=1)
    assert ledger.exhausted()


@given(st.lists(st.integers(0, 5)), st.integers(0, 20))
def test_exhausted_exactly_when_the_sum_reaches_the_limit(amounts, limit):
    ledger = Ledger(Budget(loss_calls=limit, steps=None))
    for amount in amounts:
        ledger.charge(loss_calls=amount)
    assert (ledger.exhausted() is not None) == (sum(amounts) >= limit)


def test_spent_prints_in_one_line():
    text = str(Spent(steps=1, loss_calls=2, lm_calls=3, prompt_tokens=4, completion_tokens=5))
    assert text.startswith("1 step, 2 loss calls") and "3 model calls, 9 tokens" in text
