"""Engines agree with each other, with the lasso evaluator, and with random runs."""

import pytest
from automata import formulas, random_run, systems
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from vaso.ltl import holds
from vaso.plan.transition_system import TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers import AutoVerifier, LassoVerifier, NuSMVVerifier, PyNuSMVVerifier

PYNUSMV, LASSO, AUTO = PyNuSMVVerifier(), LassoVerifier(), AutoVerifier()
DECIDED = {Verdict.PASS, Verdict.FAIL}


def examples(count: int):
    """Many examples; how long one takes says more about the machine than about the code."""
    return settings(max_examples=count, deadline=None, suppress_health_check=list(HealthCheck))


def labels(system: TransitionSystem, lasso) -> list[dict]:
    return [system.label(state, valuation) for state, valuation in lasso.run]


def check_lasso(system, formula, lasso) -> None:
    """Replay and evaluate, by means of the transition system and the evaluator alone."""
    assert lasso.run[0][0] == 0
    following = [*lasso.run[1:], lasso.run[lasso.loop_start]]
    for (state, valuation), (after, _) in zip(lasso.run, following, strict=True):
        assert set(valuation) == {s.name for s in system.sensors}
        assert system.step(state, valuation).target == after
    assert not holds(formula, labels(system, lasso), lasso.loop_start)


def check_answers(system, asked, answers, random) -> None:
    for formula, answer in zip(asked, answers, strict=True):
        assert answer.verdict in DECIDED, answer
        if answer.verdict is Verdict.FAIL:
            check_lasso(system, formula, answer.lasso)
            continue
        for _ in range(20):
            run = random_run(system, random)
            assert holds(formula, labels(system, run), run.loop_start), (formula, run)


@examples(120)
@given(systems(), st.lists(formulas(), min_size=1, max_size=3), st.randoms(use_true_random=False))
def test_verdicts_are_confirmed_by_runs(system, asked, random):
    answers = PYNUSMV.check(system, asked)
    check_answers(system, asked, answers, random)
    direct = LASSO.check(system, asked)
    for formula, one, other in zip(asked, answers, direct, strict=True):
        assert other.verdict in (one.verdict, Verdict.UNSUPPORTED), formula
    assert [a.verdict for a in AUTO.check(system, asked)] == [a.verdict for a in answers]


@examples(40)
@given(systems(max_states=8, max_sensors=0), st.lists(formulas(), min_size=1, max_size=4))
def test_the_lasso_evaluator_decides_every_system_without_sensors(system, asked):
    direct = LASSO.check(system, asked)
    assert [a.verdict for a in direct] == [a.verdict for a in PYNUSMV.check(system, asked)]
    for formula, answer in zip(asked, direct, strict=True):
        if answer.verdict is Verdict.FAIL:
            check_lasso(system, formula, answer.lasso)


@examples(30)
@given(systems(), st.lists(formulas(), min_size=1, max_size=3))
def test_pynusmv_and_the_nusmv_program_agree(system, asked):
    answers = NuSMVVerifier().check(system, asked)
    assert [a.verdict for a in answers] == [a.verdict for a in PYNUSMV.check(system, asked)]
    for formula, answer in zip(asked, answers, strict=True):
        if answer.verdict is Verdict.FAIL:
            check_lasso(system, formula, answer.lasso)


@pytest.mark.slow
@examples(1500)
@given(
    systems(max_states=10),
    st.lists(formulas(max_leaves=9), min_size=1, max_size=4),
    st.randoms(use_true_random=False),
)
def test_many_larger_systems(system, asked, random):
    answers = PYNUSMV.check(system, asked)
    check_answers(system, asked, answers, random)
    for engine in (NuSMVVerifier(), AUTO):
        assert [a.verdict for a in engine.check(system, asked)] == [a.verdict for a in answers]
