"""Reduction keeps what formulas can see, and nothing else."""

from automata import formulas, random_run, systems
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from vaso.ltl import holds, parse
from vaso.plan.transition_system import Case, Edge, Sensor, State, TransitionSystem
from vaso.verifiers.reduction import reduce
from vaso.verifiers.runs import follow, labels_along


def line(labels: list[bool]) -> TransitionSystem:
    """A straight line whose last state repeats."""
    states = tuple(State(str(i), labels={"p": p, "n": float(i)}) for i, p in enumerate(labels))
    last = len(labels) - 1
    return TransitionSystem(states, tuple((Edge({}, min(i + 1, last)),) for i in range(last + 1)))


def test_a_counter_that_does_not_show_disappears():
    assert len(reduce(line([True] * 50), [parse("G p")]).states) == 1


def test_a_counter_that_matters_stays():
    assert len(reduce(line([True] * 50 + [False]), [parse("G p")]).states) == 51
    assert len(reduce(line([True] * 50), [parse("n < 20")]).states) == 21


def test_a_long_line_is_reduced():
    system = line([i % 7 == 3 for i in range(5000)])
    assert len(reduce(system, [parse("G p")]).states) == 5000 - 4  # the last five look alike


def test_sensors_that_do_not_matter_are_dropped():
    states = (State("a", labels={"p": True}), State("b", labels={"p": True}))
    edges = ((Edge({"s": True}, 0), Edge({"s": False}, 1)), (Edge({}, 0),))
    system = TransitionSystem(states, edges, (Sensor("s"),))
    reduced = reduce(system, [parse("G p")])
    assert reduced.sensors == () and reduced.is_deterministic
    reduced.check_total()


def test_states_that_show_a_sensor_differently_are_not_merged():
    def observed(value: bool) -> dict:
        return {"o": (Case({"s": value}, True), Case({"s": not value}, False))}

    states = (State("a", observed=observed(True)), State("b", observed=observed(False)))
    system = TransitionSystem(states, ((Edge({}, 1),), (Edge({}, 0),)), (Sensor("s"),))
    assert len(reduce(system, [parse("G o")]).states) == 2


def test_states_that_a_sensor_takes_to_different_places_are_not_merged():
    states = tuple(State(str(i), labels={"p": i == 3}) for i in range(4))
    edges = (
        (Edge({"s": True}, 1), Edge({"s": False}, 2)),
        (Edge({"s": True}, 3), Edge({"s": False}, 1)),
        (Edge({"s": True}, 2), Edge({"s": False}, 3)),
        (Edge({}, 3),),
    )
    reduced = reduce(TransitionSystem(states, edges, (Sensor("s"),)), [parse("F p")])
    assert len(reduced.states) == 4


def test_states_that_cannot_be_reached_are_dropped():
    states = tuple(State("a", labels={"p": p}) for p in (True, False))
    system = TransitionSystem(states, ((Edge({}, 0),), (Edge({}, 0),)))
    assert len(reduce(system, [parse("G p")]).states) == 1


def check_same_truth(system, asked, random) -> None:
    reduced = reduce(system, asked)
    reduced.check_total()
    assert len(reduced.states) <= len(system.states)
    for _ in range(5):
        run = random_run(system, random)
        values = [valuation for _, valuation in run.run]
        image = follow(reduced, values[: run.loop_start], values[run.loop_start :])
        for formula in asked:
            truth = holds(formula, labels_along(system, run, formula), run.loop_start)
            assert holds(formula, labels_along(reduced, image, formula), image.loop_start) == truth


careful = settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
randoms = st.randoms(use_true_random=False)


@careful
@given(systems(max_states=9), st.lists(formulas(), min_size=1, max_size=2), randoms)
def test_the_same_sensor_values_give_the_same_truth(system, asked, random):
    check_same_truth(system, asked, random)


@careful
@given(systems(max_states=9, max_sensors=1), formulas(["stop"]), randoms)
def test_the_same_truth_where_much_is_merged(system, formula, random):
    check_same_truth(system, [formula], random)
