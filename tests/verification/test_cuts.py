"""Verdicts on plans that were not explored to the end."""

from dataclasses import replace

import pytest
from automata import NAMES, formulas, systems
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st

from vaso.ltl import implies, parse
from vaso.plan.transition_system import Case, Cut, Edge, Sensor, State, TransitionSystem
from vaso.verdict import Verdict
from vaso.verification.cuts import explain, strengthen, weaken
from vaso.verification.queries import Checker, Query
from vaso.verifiers import AutoVerifier, PyNuSMVVerifier

SEEN = parse("seen")
VERIFIER = PyNuSMVVerifier()


def line(*speeds: float, supported: bool = True) -> TransitionSystem:
    """Drives at the given speeds; what comes after the last one is not known."""
    cut = State("?", labels={"speed": speeds[-1]}, cut=True)
    states = (*(State("go", labels={"speed": v}) for v in speeds), cut)
    edges = tuple((Edge({}, min(i + 1, len(speeds))),) for i in range(len(states)))
    reason = Cut("the bound of 3 states was reached", 7, len(speeds) - 1, supported)
    return TransitionSystem(states, edges, cut=reason)


def verdict(system: TransitionSystem, text: str) -> Verdict:
    return Checker(system, AutoVerifier(), 60).ask([Query(parse(text))])[0].verdict


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("G(speed < 0.5)", Verdict.FAIL),  # violated before the cut
        ("G(speed < 2)", Verdict.UNKNOWN),  # and it is true of the cut state itself
        ("F(speed > 0.8)", Verdict.PASS),
        ("F(speed > 2)", Verdict.UNKNOWN),
        ("G F(speed > 0)", Verdict.UNKNOWN),
        ("!(speed > 0) U speed > 0", Verdict.PASS),
        ("X X(speed == 0.9)", Verdict.PASS),
        ("X X X(speed == 0.9)", Verdict.UNKNOWN),
        ("speed > 5 -> G(speed > 5)", Verdict.PASS),
        ("G(O(speed == 0))", Verdict.PASS),
        ("G(H(speed >= 0))", Verdict.UNKNOWN),
        ("F H(speed == 0)", Verdict.PASS),
        ("TRUE", Verdict.PASS),
        ("F G FALSE", Verdict.FAIL),
    ],
)
def test_only_what_was_explored_decides(text, expected):
    assert verdict(line(0.0, 0.3, 0.9), text) is expected


def test_the_answer_says_how_far_exploration_came():
    answer = Checker(line(0.0, 0.3, 0.9), AutoVerifier(), 60).ask([Query(parse("G(speed < 2)"))])[0]
    assert answer.reason == "explored up to step 2: the bound of 3 states was reached (line 7)"


def test_an_unsupported_construct_is_unsupported():
    assert verdict(line(0.0, supported=False), "G(speed < 2)") is Verdict.UNSUPPORTED
    assert "not explored completely" in explain(None)


def scrambled(draw, system: TransitionSystem, full: State) -> State:
    """What is said of a cut state is not to be relied on."""
    other = draw(st.sampled_from(system.states))
    kept = {n: full.observed[n] for n in ("seen",) if n in full.observed}
    labels = {n: v for n, v in other.labels.items() if n not in kept}
    if "seen" in full.labels:
        labels["seen"] = full.labels["seen"]
        kept = {}
    return State("?", labels=labels, observed={**other.observed, **kept}, cut=True)


@st.composite
def cut_systems(draw):
    """Draw a system, and the same system explored in part only."""
    full = draw(systems(max_states=6))
    sensor = full.sensors[0] if full.sensors else None
    sees = {"seen": tuple(Case({sensor.name: v}, bool(v)) for v in sensor.domain)} if sensor else {}
    fixed = {} if sensor else {"seen": True}
    states = tuple(
        replace(
            s,
            labels={**{n: v for n, v in s.labels.items() if n != "seen"}, **fixed},
            observed={**{n: c for n, c in s.observed.items() if n != "seen"}, **sees},
        )
        for s in full.states
    )
    full = replace(full, states=states)
    cuts = draw(st.sets(st.sampled_from(range(len(states))), min_size=1))
    partial = replace(
        full,
        states=tuple(scrambled(draw, full, s) if i in cuts else s for i, s in enumerate(states)),
        edges=tuple((Edge({}, i),) if i in cuts else out for i, out in enumerate(full.edges)),
        cut=Cut("bound", None, 0),
    )
    return full, partial


@settings(max_examples=120, deadline=None, suppress_health_check=list(HealthCheck))
@given(cut_systems(), st.lists(formulas(), min_size=1, max_size=3), st.booleans())
def test_a_verdict_stands_whatever_follows(pair, asked, with_assumption):
    full, partial = pair
    given_ = (parse("G F seen"),) if with_assumption else ()
    queries = [Query(f, given_) for f in asked]
    found = Checker(partial, VERIFIER, 60).ask(queries, counterexamples=True)
    whole = [implies(given_[0], f) if given_ else f for f in asked]
    truth = VERIFIER.check(full, whole, counterexamples=False)
    for formula, part, all_ in zip(asked, found, truth, strict=True):
        event(part.verdict.value)
        assert part.verdict in (all_.verdict, Verdict.UNKNOWN), formula


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(systems(), formulas(NAMES))
def test_without_cuts_all_readings_agree(system, formula):
    states = tuple(replace(s, labels={**s.labels, "__cut__": False}) for s in system.states)
    answers = VERIFIER.check(
        replace(system, states=states), [formula, weaken(formula), strengthen(formula)]
    )
    assert len({a.verdict for a in answers}) == 1


def test_assumptions_keep_their_meaning_after_a_cut():
    sees = {"seen": (Case({"s": False}, False), Case({"s": True}, True))}
    states = (
        State("go", labels={"stop": False}, observed=sees),
        State("?", labels={"stop": True}, observed=sees, cut=True),
    )
    system = TransitionSystem(
        states, ((Edge({}, 1),), (Edge({}, 1),)), (Sensor("s"),), cut=Cut("b", 1, 0)
    )
    checker = Checker(system, VERIFIER, 60)
    rule = Query(parse("G stop"), (parse("G F !seen"),))
    answer = checker.ask([rule], counterexamples=True)[0]
    assert answer.verdict is Verdict.FAIL
    assert not answer.lasso.run[-1][1]["s"]


def test_a_proof_does_not_rely_on_what_a_cut_state_says_of_the_sensors():
    states = (
        State("go", labels={"stop": True, "seen": True}),
        State("?", labels={"stop": True, "seen": False}, cut=True),
    )
    system = TransitionSystem(states, ((Edge({}, 1),), (Edge({}, 1),)), cut=Cut("bound", 1, 0))
    answer = Checker(system, VERIFIER, 60).ask([Query(parse("G stop"), (parse("G F seen"),))])[0]
    assert answer.verdict is Verdict.UNKNOWN
