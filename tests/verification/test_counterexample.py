"""Counterexamples as a person reads them."""

import pytest
from automata import formulas, random_run, systems
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from vaso import load_skill, verify
from vaso.ltl import evaluate, holds, parse
from vaso.plan.transition_system import Edge, State, TransitionSystem
from vaso.verification.counterexample import decided_at, explain_run
from vaso.verifiers.base import Lasso
from vaso.verifiers.runs import follow, labels_along

DRIVE = load_skill("drive")
PEOPLE, OBSTACLE = "yolo_listener('people')", "yolo_listener('obstacle')"


def counterexample(plan: str, text: str):
    return verify(DRIVE, plan, specs=[text]).specs[-1].counterexample


def test_steps_show_calls_lines_readings_and_labels():
    plan = "if people_observed():\n    stop()\nelse:\n    forward()\nturn_left()\n"
    example = counterexample(plan, "G(people_observed -> X stop)")
    assert [s.api for s in example.steps] == ["", "forward()", "turn_left()", "turn_left()"]
    assert [s.line for s in example.steps] == [None, 4, 5, 5]
    assert [s.sensors[PEOPLE] for s in example.steps] == [False, True, False, False]
    assert not any(s.sensors[OBSTACLE] for s in example.steps)
    assert example.steps[0].reads == (("people_observed", 1),)
    assert example.steps[1].reads == ()
    assert example.steps[1].labels["forward"] and example.steps[1].labels["speed"] == 0.3
    assert example.decided_at == 2 and example.loop_start == 3
    assert example.dt == 0.1 and example.formula == "G(people_observed -> X stop)"
    assert "ended" in example.steps[-1].note


def test_one_state_merged_from_two_lines_shows_the_line_that_was_taken():
    plan = (
        "while True:\n    if people_observed():\n        forward()\n    else:\n        forward()\n"
    )
    example = counterexample(plan, "!(people_observed & X X forward)")
    assert [s.line for s in example.steps[:2]] == [None, 3]


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("G(speed < 0.3)", 2),
        ("stop & X !stop", 1),
        ("forward", 0),
        ("G(forward -> X X X turn_left)", 5),
        ("G(stop | O turn_left)", 2),
        ("G(stop -> Y stop)", 0),
        ("!forward W turn_left", 2),
        ("F turn_left", None),
        ("G F turn_left", None),
        ("G(speed < 0.3) & F turn_left", 2),
        ("F G stop -> F turn_left", None),
    ],
)
def test_where_a_violation_is_decided(text, place):
    example = counterexample("stop()\nforward()\nforward()\nstop()\n", text)
    assert example.decided_at == place


def test_the_deciding_step_is_always_shown():
    still = TransitionSystem((State("rest", labels={"p": True, "q": False}),), ((Edge({}, 0),),))
    run = Lasso(((0, {}),), 0)
    example = explain_run(still, run, parse("G(p -> X X q)"))
    assert example.decided_at == 2 and len(example.steps) == 3 and example.loop_start == 2
    assert [s.index for s in example.steps] == [0, 1, 2]


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(systems(), formulas(), st.randoms(use_true_random=False))
def test_after_the_deciding_step_nothing_helps(system, formula, random):
    run = random_run(system, random)
    assume(not holds(formula, labels_along(system, run, formula), run.loop_start))
    place = decided_at(system, run, formula)
    example = explain_run(system, run, formula)
    assert not holds(formula, [s.labels for s in example.steps], example.loop_start)
    assume(place is not None)
    assert place < len(example.steps)
    prefix = [s.sensors for s in example.steps[: place + 1]]
    for _ in range(5):
        other = [v for _, v in random_run(system, random).run]
        found = follow(system, [*prefix, *other], other)
        labels = labels_along(system, found, formula)
        assert not evaluate(formula, labels, found.loop_start)[0]
