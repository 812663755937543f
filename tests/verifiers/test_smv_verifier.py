"""What a model checker says counts only where it is confirmed on the plan's automaton."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from vaso.ltl import parse
from vaso.plan.transition_system import Case, Edge, Sensor, State, TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers import PyNuSMVVerifier, SMVVerifier
from vaso.verifiers.engine import SMVAnswer, SMVStep, SMVTrace

SEES = {"seen": (Case({"s": False}, False), Case({"s": True}, True))}
REST = State("rest", labels={"stop": True, "speed": 0.0}, observed=SEES)
GO = State("go", labels={"stop": False, "speed": 0.3}, observed=SEES)
# stops after people were seen, goes on otherwise
GOOD = TransitionSystem(
    (REST, GO), ((Edge({"s": True}, 0), Edge({"s": False}, 1)),) * 2, (Sensor("s"),)
)
RULE = parse("G(seen -> X stop)")


class Claims:
    """An engine that claims a violation, with the trace that it was made with."""

    name = "claims"

    def __init__(self, *sensor_values: str, loop_start: int = 0, trace: bool = True) -> None:
        steps = tuple(SMVStep({"sensor_s": v, "state": "0"}) for v in sensor_values)
        self.trace = SMVTrace(steps, loop_start) if trace else None

    def check(
        self, model: str, specs: Sequence[str], *, timeout: float = 60.0, traces: bool = True
    ) -> list[SMVAnswer]:
        return [SMVAnswer(False, 0.0, self.trace if traces else None) for _ in specs]


def test_a_run_that_satisfies_the_formula_is_no_counterexample():
    answer = SMVVerifier(Claims("TRUE", "FALSE")).check(GOOD, [RULE])[0]
    assert answer.verdict is Verdict.UNKNOWN and answer.lasso is None
    assert "not confirmed: the formula is true on it" in answer.reason


def test_a_violation_without_a_run_is_not_a_verdict():
    answer = SMVVerifier(Claims(trace=False)).check(GOOD, [RULE])[0]
    assert answer.verdict is Verdict.UNKNOWN and "gave no trace" in answer.reason


def test_a_run_that_violates_the_formula_is_confirmed_whatever_the_engine_says_of_states():
    answer = SMVVerifier(Claims("FALSE", "TRUE")).check(GOOD, [parse("G stop")])[0]
    assert answer.verdict is Verdict.FAIL
    assert answer.lasso.run == ((0, {"s": False}), (1, {"s": False}))


def test_a_sensor_that_the_trace_leaves_out_has_its_default():
    silent = Claims("x")
    silent.trace = SMVTrace((SMVStep({}),), 0)
    assert SMVVerifier(silent).check(GOOD, [parse("G stop")])[0].verdict is Verdict.FAIL


@pytest.mark.parametrize("stuck", [(), (Edge({"s": True}, 0),)])
def test_a_system_that_is_not_total_is_not_decided(stuck):
    system = replace(GOOD, edges=(stuck, GOOD.edges[1]))
    for answer in PyNuSMVVerifier().check(system, [parse("G FALSE"), RULE]):
        assert answer.verdict is Verdict.UNKNOWN and "not total" in answer.reason


def test_formulas_about_something_else_do_not_spoil_the_others():
    asked = [parse(t) for t in ("G flying", "G(seen -> X stop)", "G speed", "G(1 / speed < 2)")]
    answers = PyNuSMVVerifier().check(GOOD, asked)
    assert [a.verdict for a in answers] == [
        Verdict.UNSUPPORTED, Verdict.PASS, Verdict.UNSUPPORTED, Verdict.UNSUPPORTED,
    ]  # fmt: skip
    assert "flying" in answers[0].reason and "seen, speed, stop" in answers[0].reason
    assert "compare it with a number" in answers[2].reason
    assert "divides by zero" in answers[3].reason


def test_a_time_out_is_unknown():
    answer = PyNuSMVVerifier().check(GOOD, [RULE], timeout=0.0)[0]
    assert answer.verdict is Verdict.UNKNOWN and answer.reason


def test_without_counterexamples_there_is_only_the_verdict():
    answer = PyNuSMVVerifier().check(GOOD, [parse("G stop")], counterexamples=False)[0]
    assert answer.verdict is Verdict.FAIL and answer.lasso is None
