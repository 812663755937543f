"""The explicit-state model checker against PyNuSMV: two engines with no code in common."""

from automata import formulas, systems
from hypothesis import HealthCheck, event, given, settings

from tests.plan.contracts import DRIVE
from vaso.ltl import has_past, parse
from vaso.plan import compile_plan
from vaso.verdict import Verdict
from vaso.verifiers import ExplicitVerifier, PyNuSMVVerifier, get_verifier, witness
from vaso.verifiers.runs import objection


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(systems(), formulas())
def test_the_two_engines_agree(system, formula):
    mine = ExplicitVerifier().check(system, [formula])[0]
    event(mine.verdict.value)
    if has_past(formula):
        assert mine.verdict is Verdict.UNSUPPORTED and "back" in mine.reason
        return
    other = PyNuSMVVerifier().check(system, [formula], counterexamples=False)[0]
    assert mine.verdict is other.verdict
    if mine.verdict is Verdict.FAIL:
        assert mine.lasso is not None and not objection(system, mine.lasso, formula)


def test_an_unknown_proposition_is_not_a_verdict():
    system = compile_plan("forward()\n", DRIVE)
    answers = get_verifier("explicit").check(
        system, [parse("G nowhere"), parse("F forward"), parse("G stop")]
    )
    assert [a.verdict for a in answers] == [Verdict.UNSUPPORTED, Verdict.PASS, Verdict.FAIL]


def test_a_search_that_grows_too_large_is_unknown(monkeypatch):
    monkeypatch.setattr(witness, "MAX_NODES", 1)
    source = "while True:\n    stop() if people_observed() else forward()\n"
    answer = ExplicitVerifier().check(compile_plan(source, DRIVE), [parse("G(stop -> F forward)")])
    assert answer[0].verdict is Verdict.UNKNOWN and "large" in answer[0].reason


def test_no_time_is_no_verdict():
    system = compile_plan("forward()\n", DRIVE)
    assert (
        ExplicitVerifier().check(system, [parse("F forward")], timeout=-1.0)[0].verdict
        is Verdict.UNKNOWN
    )
