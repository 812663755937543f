"""Choosing a verifier, and which engine decides what."""

import pytest

from vaso.errors import VerifierError
from vaso.ltl import parse
from vaso.plan.transition_system import Case, Edge, Sensor, State, TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers import AutoVerifier, LassoVerifier, NuSMVVerifier, get_verifier

SEES = {"seen": (Case({"s": False}, False), Case({"s": True}, True))}
STATES = tuple(
    State(str(i), labels={"speed": 0.3, "last": i == 2}, observed=SEES) for i in range(3)
)
LINE = TransitionSystem(STATES, ((Edge({}, 1),), (Edge({}, 2),), (Edge({}, 2),)), (Sensor("s"),))
BRANCHING = TransitionSystem(
    STATES, ((Edge({"s": True}, 1), Edge({"s": False}, 2)), *LINE.edges[1:]), (Sensor("s"),)
)
TEXTS = ["G(speed < 0.5)", "F last", "X last", "G !seen"]


def engines(system) -> list[str]:
    return [a.engine for a in AutoVerifier().check(system, [parse(t) for t in TEXTS])]


def verdicts(verifier, system) -> list[str]:
    return [a.verdict.value for a in verifier.check(system, [parse(t) for t in TEXTS])]


def test_auto_evaluates_directly_what_has_one_behaviour():
    assert engines(LINE) == ["lasso", "lasso", "lasso", "pynusmv"]
    assert engines(BRANCHING) == ["lasso", "pynusmv", "pynusmv", "pynusmv"]


def test_lasso_refuses_what_sensors_decide():
    assert verdicts(LassoVerifier(), LINE) == ["pass", "pass", "fail", "unsupported"]
    assert verdicts(LassoVerifier(), BRANCHING) == ["pass", *["unsupported"] * 3]
    reasons = [a.reason for a in LassoVerifier().check(BRANCHING, [parse(t) for t in TEXTS])]
    assert "more than one behaviour" in reasons[1] and "sensors" in reasons[3]


def test_lasso_shows_the_run():
    answer = LassoVerifier().check(LINE, [parse("G !last")])[0]
    assert [s for s, _ in answer.lasso.run] == [0, 1, 2] and answer.lasso.loop_start == 2


def test_lasso_refuses_unknown_propositions_and_systems_that_are_not_total():
    assert LassoVerifier().check(LINE, [parse("G up")])[0].verdict is Verdict.UNSUPPORTED
    stuck = TransitionSystem(STATES[:1], ((),))
    assert LassoVerifier().check(stuck, [parse("G !last")])[0].verdict is Verdict.UNKNOWN


@pytest.mark.parametrize("name", ["auto", "pynusmv", "nusmv", "Lasso", None])
def test_verifiers_by_name(name):
    found = get_verifier(name)
    assert found.name == (name or "auto").lower()
    assert get_verifier(found) is found


@pytest.mark.parametrize("name", ["auto", "pynusmv", "nusmv"])
def test_every_complete_verifier_gives_the_same_verdicts(name):
    assert verdicts(get_verifier(name), BRANCHING) == ["pass", "pass", "fail", "fail"]


def test_an_unknown_name_is_refused():
    with pytest.raises(VerifierError, match=r"'z3'.*\n.*auto, pynusmv, nusmv, nuxmv, lasso"):
        get_verifier("z3")


def test_a_missing_program_is_refused(tmp_path):
    with pytest.raises(VerifierError, match="no program"):
        NuSMVVerifier(tmp_path / "nothing")
