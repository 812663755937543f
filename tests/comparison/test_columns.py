import pytest

from vaso.comparison import COLUMNS, Row
from vaso.comparison.columns import number, show, spread


def test_every_column_is_a_value_of_a_row_and_says_what_it_means():
    for name, column in COLUMNS.items():
        assert name == column.name and name in Row.model_fields
        assert column.meaning.endswith(".") and column.label


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0, "0"),
        (3, "3"),
        (2.5, "2.5"),
        (99.96, "100.0"),
        (123.4, "123"),
        (9999, "9999"),
        (9999.9, "10.0k"),
        (48_123, "48.1k"),
        (999_999, "1000k"),
        (1_234_567, "1.2M"),
        (3e9, "3.0G"),
    ],
)
def test_numbers_are_short(value, shown):
    assert number(value) == shown
    assert len(shown) <= 5


def test_values_have_the_unit_of_their_column():
    assert show("safety", 0.75) == "75%"
    assert show("safety", 0.99999) == "99.9%"
    assert show("seconds", 1.25) == "1.2 s"
    assert show("cost", 0.012345) == "$0.0123"
    assert show("tokens", None) == "–"


def test_a_standard_deviation_of_one_value_is_a_dash():
    assert spread("safety", None) == "±–"
    assert spread("safety", 0.125) == "±12.5%"
    assert spread("steps", 0.0) == "±0"
    assert spread("seconds", 0.5) == "±0.5 s"
