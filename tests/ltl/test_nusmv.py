import pytest
from hypothesis import given
from ltl_samples import BOOLEANS, decidable, lassos

from vaso.errors import FormulaError
from vaso.ltl import evaluate, parse, to_nusmv

NAMES = {name: f"p_{name}" for name in "abcGF"}


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("G(a -> X !b)", "(G (p_a -> (X (! p_b))))"),
        ("a U b V c", "((p_a U p_b) V p_c)"),
        ("a W b", "(p_b V (p_a | p_b))"),
        ("a xor b <-> TRUE", "((p_a xor p_b) <-> TRUE)"),
        ("Z a & (b T c)", "((Z p_a) & (p_b T p_c))"),
        ("x < 1 -> a", "(cmp -> p_a)"),
    ],
)
def test_to_nusmv(text, printed):
    assert to_nusmv(parse(text), NAMES, lambda _: "cmp") == printed


@given(decidable, lassos())
def test_the_printed_formula_means_the_same(formula, lasso):
    steps, loop_start = lasso
    comparisons = []

    def name_comparison(comparison):
        comparisons.append(comparison)
        return f"({comparison})"

    printed = to_nusmv(formula, {name: name for name in BOOLEANS}, name_comparison)
    assert " W " not in printed
    assert evaluate(parse(printed), steps, loop_start) == evaluate(formula, steps, loop_start)


def test_names_may_be_a_function():
    assert to_nusmv(parse("G a"), str.upper, str) == "(G A)"


def test_what_the_model_lacks_is_named():
    with pytest.raises(FormulaError, match="door_open is not part of the model"):
        to_nusmv(parse("G door_open"), NAMES)
    with pytest.raises(FormulaError, match="x < 1 has no counterpart"):
        to_nusmv(parse("G(x < 1)"), NAMES)
