import itertools

import pytest
from gradient_samples import OBSERVED, example, step
from hypothesis import given
from hypothesis import strategies as st

from vaso.gradient.failure import find_failure
from vaso.ltl import Binary, Formula, Unary, evaluate, holds, parse

WORLD = frozenset({"p", "q"})


def found(
    formula: str, *states: str, loop: int = 0
) -> tuple[str, int, bool, list[tuple[str, int]]]:
    """The failure on a lasso whose states are given as the letters that hold in them."""
    steps = [step(**{n: n in s for n in "pqab"}) for s in states]
    failure = find_failure(parse(formula), example(formula, steps, loop), WORLD)
    assert failure is not None
    because = [(str(f.formula), f.step) for f in failure.because]
    return str(failure.missing), failure.step, failure.never, because


@pytest.mark.parametrize(
    ("formula", "states", "expected"),
    [
        ("G a", ("a", "a", "b"), ("a", 2, False, [])),
        ("G(p -> X a)", ("a", "pa", "b"), ("a", 2, False, [("p", 1)])),
        ("G(!p | X a)", ("a", "pa", "b"), ("a", 2, False, [("p", 1)])),
        ("G(X a | !p)", ("a", "pa", "b"), ("a", 2, False, [("p", 1)])),
        ("G !(p & X b)", ("a", "pa", "b"), ("!b", 2, False, [("p", 1)])),
        ("!F(p & a)", ("q", "pa"), ("!a", 1, False, [("p", 1)])),
        ("F a", ("b", "p"), ("a", 0, True, [])),
        ("F p -> F a", ("b", "p"), ("a", 0, True, [("p", 1)])),
        ("G(p -> F a)", ("a", "p", "q"), ("a", 1, True, [("p", 1)])),
        ("a U b", ("a", "a"), ("b", 0, True, [])),
        ("a U b", ("a", "p", "b"), ("a", 1, False, [])),
        ("a W b", ("a", "p"), ("a", 1, False, [])),
        ("b V a", ("a", "q"), ("a", 1, False, [])),
        ("G a & G b", ("ab", "a"), ("b", 1, False, [])),
        ("G(p & q -> a)", ("pa", "pq"), ("a", 1, False, [("p", 1), ("q", 1)])),
        ("G(p | q -> a)", ("a", "q"), ("a", 1, False, [("q", 1)])),
        ("G(p -> (q -> X a))", ("pqa", "b"), ("a", 1, False, [("p", 0), ("q", 0)])),
        ("G(a -> Y b)", ("b", "a", "a"), ("Y b", 2, False, [("a", 2)])),
        ("G(a <-> b)", ("ab", "a"), ("a <-> b", 1, False, [])),
    ],
)
def test_failures(formula: str, states: tuple[str, ...], expected: object) -> None:
    assert found(formula, *states, loop=len(states) - 1) == expected


def test_what_looks_back_may_fail_only_in_the_second_turn() -> None:
    # a holds before the loop is entered, not when it is entered again from its end.
    assert found("G(b -> Y a)", "a", "b", loop=1)[0] == "Y a"


def test_a_formula_that_holds_has_no_failure() -> None:
    assert find_failure(parse("F p"), example("F p", [step(p=True)], 0)) is None


formulas = st.recursive(
    st.sampled_from([parse(n) for n in "pqab"]),
    lambda inner: st.one_of(
        st.builds(Unary, st.sampled_from("!XFGYO"), inner),
        st.builds(
            Binary, st.sampled_from(["&", "|", "->", "<->", "U", "V", "W", "S"]), inner, inner
        ),
    ),
    max_leaves=5,
)
lassos = st.tuples(
    st.lists(st.sets(st.sampled_from("pqab")), min_size=1, max_size=4), st.integers(0, 3)
)


@given(formulas, lassos)
def test_what_is_said_is_true(formula: Formula, lasso: tuple[list[set[str]], int]) -> None:
    states, loop = lasso[0], min(lasso[1], len(lasso[0]) - 1)
    steps = [step(**{n: n in s for n in "pqab"}) for s in states]
    shown = example(str(formula), steps, loop)
    failure = find_failure(formula, shown, WORLD)
    labels = [dict(s.labels) for s in shown.steps]
    assert (failure is None) == holds(formula, labels, loop)
    if failure is None:
        return
    truth = evaluate(failure.missing, labels, loop)
    past = any(n in str(formula) for n in "YOS")
    if not past:  # with past operators, steps of later turns count too
        assert not truth[failure.step]
        for fact in failure.because:
            assert evaluate(fact.formula, labels, loop)[fact.step]
    if failure.never and not past:
        assert not any(itertools.islice(truth, failure.step, None))


def test_the_samples_observe_what_they_say() -> None:
    assert {"people_observed", "obstacle_observed"} == OBSERVED
