"""Violating runs from the explicit automaton."""

import pytest
from automata import formulas, systems
from hypothesis import HealthCheck, event, given, settings

from vaso.ltl import has_past, parse
from vaso.plan.transition_system import Case, Edge, Sensor, State, TransitionSystem
from vaso.verdict import Verdict
from vaso.verifiers import PyNuSMVVerifier
from vaso.verifiers.components import components
from vaso.verifiers.runs import follow, violates
from vaso.verifiers.witness import find_violation

SEES = {"seen": (Case({"s": False}, False), Case({"s": True}, True))}


def corridor(length: int) -> TransitionSystem:
    """Steps on while something is seen, waits otherwise, and stays at the end."""
    last = length - 1
    states = (
        State(str(i), labels={"end": i == last, "half": i == last // 2}, observed=SEES)
        for i in range(length)
    )
    edges = ((Edge({"s": True}, min(i + 1, last)), Edge({"s": False}, i)) for i in range(length))
    return TransitionSystem(tuple(states), tuple(edges), (Sensor("s"),))


@settings(max_examples=250, deadline=None, suppress_health_check=list(HealthCheck))
@given(systems(), formulas().filter(lambda f: not has_past(f)))
def test_the_search_finds_a_run_exactly_where_the_model_checker_says_so(system, formula):
    verdict = PyNuSMVVerifier().check(system, [formula], counterexamples=False)[0].verdict
    event(verdict.value)
    word = find_violation(system, formula)
    assert (word is not None) == (verdict is Verdict.FAIL)
    if word is not None:
        assert violates(system, follow(system, *word), formula)


def test_the_shortest_violation_of_a_safety_rule_is_found():
    prefix, loop = find_violation(corridor(600), parse("G(half -> X !seen)"))
    assert len(prefix) == 301 and loop == ({},)


@pytest.mark.parametrize(
    ("text", "violated"),
    [
        ("F end", True),
        ("G F seen -> F end", False),
        ("G F seen & G F !seen -> F G end", False),
        ("F G seen | F G !seen", True),
        ("F end | G F !seen", False),
        ("(F half) & (F end)", True),
    ],
)
def test_cycles_keep_every_promise(text, violated):
    system, formula = corridor(5), parse(text)
    word = find_violation(system, formula)
    assert (word is not None) == violated
    if word:
        assert violates(system, follow(system, *word), formula)


def test_what_is_too_large_is_left_to_the_engine():
    many = tuple(Sensor(f"s{i}") for i in range(8))
    system = TransitionSystem((State("a", labels={"p": True}),), ((Edge({}, 0),),), many)
    assert find_violation(system, parse("G !p")) is None
    assert find_violation(corridor(5), parse("G !(O half)")) is None


def test_a_past_formula_is_still_refuted():
    answer = PyNuSMVVerifier().check(corridor(5), [parse("G !(seen & O half)")])[0]
    assert answer.verdict is Verdict.FAIL and len(answer.lasso.run) == 4


def test_a_formula_as_deep_as_the_parser_takes():
    text = "X " * 400 + "end"
    answer = PyNuSMVVerifier().check(corridor(3), [parse(text)])[0]
    assert answer.verdict is Verdict.FAIL


@pytest.mark.parametrize(
    ("graph", "expected"),
    [
        ([[1], [2], [0], [3], []], [[0, 1, 2], [3], [4]]),
        ([[0]], [[0]]),
        ([[1, 2], [0], [3], [2]], [[0, 1], [2, 3]]),
        ([], []),
    ],
)
def test_components(graph, expected):
    assert sorted(map(sorted, components(graph))) == expected


def test_components_of_a_long_path():
    assert len(components([[i + 1] for i in range(20_000)] + [[0]])) == 1
