"""Counterexamples that people can read."""

from vaso.ltl import parse
from vaso.plan.transition_system import Case, Edge, Sensor, State, TransitionSystem
from vaso.verifiers.base import Lasso
from vaso.verifiers.runs import follow, objection, tidy
from vaso.verifiers.shortening import shorten

SENSORS = (Sensor("a"), Sensor("b"))
SEES = {n: (Case({n: False}, False), Case({n: True}, True)) for n in ("a", "b")}


def looper(states: int) -> TransitionSystem:
    """Goes round in a circle while `a` is seen, else back to the start."""
    names = [State(str(i), labels={"last": i == states - 1}, observed=SEES) for i in range(states)]
    edges = tuple(
        (Edge({"a": True}, (i + 1) % states), Edge({"a": False}, 0)) for i in range(states)
    )
    return TransitionSystem(tuple(names), edges, SENSORS)


def values(a: str, b: str) -> list[dict]:
    return [{"a": x == "1", "b": y == "1"} for x, y in zip(a, b, strict=True)]


def shortened(system, prefix, loop, text) -> Lasso:
    formula = parse(text)
    lasso = follow(system, prefix, loop)
    assert not objection(system, lasso, formula)
    found = shorten(system, lasso, formula)
    assert not objection(system, found, formula)
    return found


def test_detours_and_sensors_that_do_not_matter_go():
    system = looper(3)
    found = shortened(system, values("10101101", "11011011"), values("10", "11"), "G !last")
    assert [state for state, _ in found.run] == [0, 1, 2, 0]
    assert [v["a"] for _, v in found.run] == [True, True, False, False]
    assert not any(v["b"] for _, v in found.run)


def test_sensors_that_matter_stay():
    found = shortened(looper(2), values("0", "1"), values("0", "1"), "F G !b")
    assert found.run == ((0, {"a": False, "b": True}),)


def test_a_loop_is_written_once():
    turn = [(0, {"a": True}), (1, {"a": False})]
    assert tidy(Lasso((*turn, *turn, *turn), 2)) == Lasso(tuple(turn), 0)
    assert tidy(Lasso((turn[1], *turn), 1)) == Lasso((turn[1], turn[0]), 0)


def test_following_unrolls_the_loop_until_the_control_state_repeats():
    found = follow(looper(3), [], values("1", "0"))
    assert [state for state, _ in found.run] == [0, 1, 2] and found.loop_start == 0
    assert follow(looper(30), [], values("1", "0"), limit=10) is None


def test_a_run_that_does_not_fit_the_system_is_objected_to():
    system, formula = looper(3), parse("G !last")
    here = {"a": True, "b": False}
    assert "initial" in objection(system, Lasso(((1, here),), 0), formula)
    assert "step 0" in objection(system, Lasso(((0, here), (2, here)), 0), formula)
    assert "step 2" in objection(system, Lasso(((0, here), (1, here), (2, here)), 1), formula)
    assert "is true on it" in objection(system, Lasso(((0, {"a": False, "b": True}),), 0), formula)
    assert not objection(system, Lasso(((0, here), (1, here), (2, here)), 0), formula)


def test_a_long_counterexample_is_shortened_within_bounds():
    found = shortened(looper(400), values("1" * 399, "1" * 399), values("1", "1"), "G !last")
    assert len(found.run) <= 401
    assert not any(v["b"] for _, v in found.run)
