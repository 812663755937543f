import copy
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st
from ltl_samples import formulas, terms

from vaso.errors import FormulaError
from vaso.ltl import (
    FALSE,
    TRUE,
    Binary,
    Number,
    Proposition,
    Unary,
    Variable,
    always,
    conjunction,
    disjunction,
    eventually,
    implies,
    negate,
    next_step,
    parse,
)

P, Q = Proposition("p"), Proposition("q")


@given(formulas)
def test_pickled_and_copied_formulas_are_equal(formula):
    again = pickle.loads(pickle.dumps(formula))
    assert again == formula and hash(again) == hash(formula)
    assert copy.deepcopy(formula) is formula


@given(terms)
def test_pickled_terms_are_equal(term):
    assert pickle.loads(pickle.dumps(term)) == term


@given(st.sampled_from([P, Q, TRUE, FALSE, Variable("p"), Number(1)]), formulas)
def test_different_nodes_are_not_equal(node, formula):
    assert (node == formula) == (str(node) == str(formula) and type(node) is type(formula))


def test_equality_with_other_types():
    assert P != "p"
    assert Variable("p") != P
    assert Number(0.0) == Number(-0.0)
    assert len({parse("G p"), always(P), Unary("G", Proposition("p"))}) == 1


def test_nodes_are_immutable():
    with pytest.raises(AttributeError):
        P.name = "q"


def test_constructors():
    assert str(always(implies(P, next_step(Q)))) == "G(p -> X q)"
    assert str(eventually(P)) == "F p"
    assert negate(negate(P)) == P
    assert negate(TRUE) == FALSE
    assert conjunction([]) == TRUE
    assert disjunction([]) == FALSE
    assert conjunction([P]) == P
    assert str(conjunction([P, Q, P])) == "p & q & p"
    assert str(disjunction([P, Q])) == "p | q"


@pytest.mark.parametrize(
    "name", ["G", "U", "not", "Always", "TRUE", "people observed", "1p", "", "é"]
)
def test_names_that_would_not_read_back_are_refused(name):
    with pytest.raises(FormulaError):
        Proposition(name)


@pytest.mark.parametrize("value", [float("inf"), float("nan")])
def test_numbers_are_finite(value):
    with pytest.raises(FormulaError):
        Number(value)


def test_deep_formulas_compare_hash_and_pickle():
    def tower():
        formula = P
        for _ in range(3000):
            formula = Binary("&", Unary("!", formula), Q)
        return formula

    first, second = tower(), tower()
    assert first == second and hash(first) == hash(second)
    assert first != Unary("!", second)
    assert pickle.loads(pickle.dumps(first)) == first
