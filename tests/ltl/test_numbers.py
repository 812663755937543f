import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vaso.errors import FormulaError
from vaso.ltl import compare, parse, value_of
from vaso.ltl.numbers import truths


@pytest.mark.parametrize(
    ("text", "x", "truth"),
    [
        ("x < 1", 1, False),
        ("x <= 1", 1, True),
        ("x > 1", 1.5, True),
        ("x >= 1", 0.5, False),
        ("x != 1", 2, True),
        ("x == 0.3", 0.1 + 0.2, True),
        ("x <= 0.3", 0.1 + 0.2, True),
        ("x > 0.3", 0.1 + 0.2, False),
        ("x < 1", 1 - 1e-12, False),
        ("x < 1", 1 - 1e-8, True),
        ("2 * x + 1 - x / 2 == 4", 2, True),
        ("-x < 0", 1, True),
    ],
)
def test_compare(text, x, truth):
    assert compare(parse(text), {"x": x}) is truth


@pytest.mark.parametrize(
    ("text", "step", "message"),
    [
        ("1 / (x - 1) < 2", {"x": 1}, r"1 / \(x - 1\) divides by zero, because x - 1 is 0"),
        ("x < 1", {"x": math.nan}, "x < 1 cannot be decided, because x is nan"),
        ("x < 1", {"x": -math.inf}, "because x is -inf"),
        ("x * x < 1", {"x": 1e300}, r"because x \* x is inf"),
        ("x < 1", {"x": 10**400}, "too large"),
        ("x < 1", {"y": 1}, "x has no value"),
        ("x < 1", {"x": True}, "x has the value True"),
        ("x < 1", {"x": "fast"}, "x has the value 'fast'"),
    ],
)
def test_values_that_cannot_be_compared(text, step, message):
    with pytest.raises(FormulaError, match=message):
        compare(parse(text), step)


def test_value_of():
    assert value_of(parse("a * (b - 1) < 0").left, {"a": 2, "b": 4}) == 6


@given(
    st.sampled_from(["x < 1", "x == 0.3", "1 <= x", "x + 0 > 2", "x != 0"]),
    st.lists(st.floats(-3, 3, width=32)),
)
def test_many_steps_at_once_are_the_same_as_one_by_one(text, values):
    comparison = parse(text)
    steps = [{"x": value} for value in [0.1 + 0.2, 1.0000000001, 1, *values]]
    assert truths(comparison, steps) == [compare(comparison, step) for step in steps]
