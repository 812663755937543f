import pytest
from hypothesis import given, settings
from ltl_samples import decidable, formulas, lassos

from vaso.ltl import (
    Proposition,
    Unary,
    evaluate,
    is_syntactically_safe,
    negate,
    nnf,
    parse,
    simplify,
    size,
    subformulas,
)


@settings(max_examples=500)
@given(decidable, lassos())
def test_normal_forms_mean_the_same(formula, lasso):
    truth = evaluate(formula, *lasso)
    assert evaluate(nnf(formula), *lasso) == truth
    assert evaluate(simplify(formula), *lasso) == truth
    assert evaluate(nnf(negate(formula)), *lasso) == tuple(not value for value in truth)


@settings(max_examples=200)
@given(formulas)
def test_nnf_negates_propositions_only(formula):
    for part in subformulas(nnf(formula)):
        if isinstance(part, Unary) and part.op == "!":
            assert isinstance(part.operand, Proposition)
        assert getattr(part, "op", "&") not in ("->", "<->", "xor")


@settings(max_examples=200)
@given(formulas)
def test_simplify_never_grows_and_is_stable(formula):
    simple = simplify(formula)
    assert size(simple) <= size(formula)
    assert simplify(simple) == simple


@pytest.mark.parametrize(
    ("text", "normal"),
    [
        ("!G(a -> X b)", "F(a & X !b)"),
        ("!(x < 1)", "x >= 1"),
        ("!(x == 1)", "x != 1"),
        ("!(a U b)", "!a V !b"),
        ("!(a W b)", "!b U (!a & !b)"),
        ("!(a S b)", "!a T !b"),
        ("!Y a", "Z !a"),
        ("!O a", "H !a"),
        ("a <-> b", "a & b | !a & !b"),
        ("a xor b", "a & !b | !a & b"),
        ("!!a", "a"),
        ("!TRUE", "FALSE"),
    ],
)
def test_nnf(text, normal):
    assert nnf(parse(text)) == parse(normal)


@pytest.mark.parametrize(
    ("text", "simple"),
    [
        ("G(a & TRUE) | FALSE", "G a"),
        ("F F a", "F a"),
        ("F G F a", "G F a"),
        ("a & !a", "FALSE"),
        ("a -> a", "TRUE"),
        ("TRUE -> a", "a"),
        ("a -> FALSE", "!a"),
        ("a <-> FALSE", "!a"),
        ("a xor TRUE", "!a"),
        ("TRUE U a", "F a"),
        ("a W FALSE", "G a"),
        ("Y TRUE", "Y TRUE"),
        ("Y FALSE", "FALSE"),
        ("Z FALSE", "Z FALSE"),
    ],
)
def test_simplify(text, simple):
    assert simplify(parse(text)) == parse(simple)


def test_nested_equivalences_stay_small_in_memory():
    formula = parse(" <-> ".join(["a", "b"] * 100))
    assert sum(1 for _ in subformulas(nnf(formula))) < 2_000


@pytest.mark.parametrize(
    ("text", "safe"),
    [
        ("G(people_observed -> X stop)", True),
        ("G(speed < 0.5)", True),
        ("!F(a & X b)", True),
        ("G(a -> O b)", True),
        ("a W b", True),
        ("a U b", False),
        ("G(a -> F b)", False),
        ("!G a", False),
    ],
)
def test_is_syntactically_safe(text, safe):
    assert is_syntactically_safe(parse(text)) is safe
