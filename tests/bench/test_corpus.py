import random

import pytest

from vaso.bench.corpus import Case, Result, corpus, decide_all, small, summary
from vaso.bench.corpus.hard import ring, steps
from vaso.feasibility import satisfiable
from vaso.ltl import GENERATED, parse
from vaso.verifiers.pynusmv_engine import PyNuSMVEngine


def test_every_small_formula_is_decided_and_no_answer_is_wrong() -> None:
    results = list(decide_all(small(), limit=60))
    assert not [r for r in results if r.wrong or r.sat is None]
    assert all(r.confirmed for r in results if r.sat)
    assert {r.sat for r in results if r.expected is None} == {True, False}


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_a_model_checker_agrees_on_the_small_formulas() -> None:
    for case in small():
        known = satisfiable(case.formula, engine=PyNuSMVEngine(), timeout=60).sat
        assert known is not None
        assert satisfiable(case.formula, timeout=60).sat is known, case.name
        assert case.sat in (None, known), case.name


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_labels_hold_in_the_published_sizes() -> None:
    """A sample; a formula that is not decided is no failure here, a wrong answer is."""
    labelled = [case for case in corpus() if case.sat is not None]
    results = list(decide_all(random.Random(0).sample(labelled, 80), limit=20))
    assert not [r.name for r in results if r.wrong]
    assert sum(r.sat is not None for r in results) >= 70


@pytest.mark.slow
@pytest.mark.parametrize("family", [steps, ring])
@pytest.mark.timeout(600)
def test_a_model_checker_agrees_on_random_clauses(family) -> None:
    for seed in range(8):
        case = family(7, 21 + seed, seed)
        assert satisfiable(case.formula, timeout=60).sat is (
            satisfiable(case.formula, engine=PyNuSMVEngine(), timeout=60).sat
        )


def test_formulas_read_as_they_are_meant() -> None:
    cases = list(corpus())
    assert len(cases) > 500 and len({(c.family, c.name) for c in cases}) == len(cases)
    for case in cases[::25]:
        assert parse(case.formula, limits=GENERATED)


def test_a_wrong_answer_is_noticed() -> None:
    lying = [Case("family", "one", "F p", False), Case("family", "two", "p & !p", None)]
    results = list(decide_all(lying, limit=10))
    assert [r.wrong for r in results] == [True, False]
    row = summary(results)[0]
    assert (row.formulas, row.sat, row.unsat, row.wrong) == (2, 1, 1, 1)


def test_plain_nusmv_is_asked_about_some() -> None:
    cases = [Case("family", f"{i}", "G(p -> F q) & F p", True) for i in range(3)]
    results = list(decide_all(cases, limit=30, plain_every=2))
    assert [r.plain for r in results] == [True, None, True]
    assert summary(results)[-1].plain_asked == 2


def test_disagreement_with_nusmv_is_wrong() -> None:
    result = Result("f", "n", None, sat=True, confirmed=True, seconds=0, cpu=0, plain=False)
    assert result.wrong
