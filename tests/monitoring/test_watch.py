"""Rules watched during a run: what is open, what is awaited, what a measurement can tell."""

import math

import pytest
from pydantic import ValidationError

from vaso import get_platform, load_skill
from vaso.ltl import parse
from vaso.monitoring import Truth, Watch
from vaso.monitoring.tolerance import EXACT, Tolerance
from vaso.platforms import Platform
from vaso.skill import Rule

PX4 = get_platform("px4")
SQUARE = load_skill("fly-in-square-shape-traj")


def watch(*rules: str, tolerance=EXACT) -> Watch:
    return Watch([Rule(text=r) for r in rules], tolerance)


def run(found: Watch, *steps) -> list[tuple]:
    for step in steps:
        found.observe(step)
    return [(s.truth, s.step) for s in found.statuses]


def test_what_is_awaited():
    found = watch("G(p -> F q)", "F p & F q", "p U q", "G F p", "F G p", "F p -> F q")
    run(found, {"p": True, "q": False})
    awaited = [[str(f) for f in s.awaited] for s in found.statuses]
    assert awaited == [["q"], ["q"], ["q"], [], [], ["q"]]
    run(found, {"p": False, "q": True})
    assert [[str(f) for f in s.awaited] for s in found.statuses] == [[], [], [], ["p"], ["G p"], []]
    assert [s.truth for s in found.statuses] == [
        Truth.OPEN, Truth.SATISFIED, Truth.SATISFIED, Truth.OPEN, Truth.OPEN, Truth.SATISFIED,
    ]  # fmt: skip


def test_the_safety_part_of_a_mixed_rule_is_watched():
    assert run(watch("G(p -> (q U r))"), {"p": True, "q": True, "r": False}) == [(Truth.OPEN, None)]
    broken = {"p": False, "q": False, "r": False}
    found = watch("G(p -> (q U r))")
    assert run(found, {"p": True, "q": True, "r": False}, broken) == [(Truth.VIOLATED, 1)]
    assert not found.statuses[0].is_safety


def test_what_nothing_can_keep_is_violated_in_the_first_step():
    assert run(watch("G p & F !p"), {"p": True})[0][0] is Truth.OPEN
    assert run(watch("X p & X !p"), {"p": True}) == [(Truth.VIOLATED, 0)]


def test_values_that_are_missing():
    found = watch("G p", "G(p | q)", "F q")
    run(found, {"q": True}, {"p": True, "q": False})
    assert [s.unknown for s in found.statuses] == [("p",), ("p",), ()]
    assert [s.truth for s in found.statuses] == [Truth.OPEN, Truth.OPEN, Truth.SATISFIED]
    assert run(found, {"p": False, "q": False})[0] == (Truth.VIOLATED, 2)
    assert run(watch("G(x < 1)"), {"x": math.nan}, {"x": 2.0}) == [(Truth.VIOLATED, 1)]


def test_a_rule_that_cannot_be_watched():
    (status,) = watch("G(O(X p))").statuses
    assert "past operator" in status.problem and status.truth is Truth.OPEN


def test_lines_for_people():
    found = Watch.of(load_skill("drive"))
    base = {"people_observed": True, "obstacle_observed": False, "speed": 0.0, "forward": False}
    run(found, base | {"stop": True}, base | {"stop": False})
    assert found.describe(get_platform("jackal")) == [
        "✗ whenever people are observed, the next command is stop (violated in step 1)",
        "· whenever an obstacle is observed, the next command is not forward (kept so far)",
        "· speed always stays below 0.5 (kept so far)",
        "✓ if at some time neither people nor an obstacle is observed, then at some time the command is not stop",
    ]


@pytest.mark.parametrize(
    ("rule", "values", "truth"),
    [
        (
            "G(altitude == 0 -> linear_velocity == 0)",
            {"altitude": 0.2, "linear_velocity": 0.5},
            "open",
        ),
        (
            "G(altitude == 0 -> linear_velocity == 0)",
            {"altitude": 0.0, "linear_velocity": 0.05},
            "open",
        ),
        (
            "G(altitude == 0 -> linear_velocity == 0)",
            {"altitude": 0.0, "linear_velocity": 0.5},
            "violated",
        ),
        (
            "F(linear_velocity == 0 & altitude == 0)",
            {"altitude": 0.2, "linear_velocity": 0.05},
            "satisfied",
        ),
        ("F(altitude > 0)", {"altitude": 0.2}, "open"),
        ("F(altitude > 0)", {"altitude": 0.4}, "satisfied"),
        ("G(linear_velocity <= 1)", {"linear_velocity": 1.05}, "open"),
        ("G(linear_velocity <= 1)", {"linear_velocity": 1.15}, "violated"),
        ("G(altitude < 10)", {"altitude": 10.0}, "violated"),
        ("G(altitude < 10)", {"altitude": 9.99}, "open"),
    ],
)
def test_measured_numbers(rule, values, truth):
    assert run(watch(rule, tolerance=Tolerance.of(PX4)), values)[0][0] == truth


def test_without_a_platform_numbers_are_exact():
    assert (
        run(watch("G(linear_velocity <= 1)"), {"linear_velocity": 1.0001})[0][0] is Truth.VIOLATED
    )
    assert EXACT.letter([parse("x == 1")], {"x": 1.0000000001}) == (True,), "nine decimals"


@pytest.mark.parametrize("value", [-0.1, math.inf, math.nan])
def test_an_accuracy_that_is_none_is_refused(value):
    fields = {n: getattr(PX4, n) for n in Platform.model_fields}
    with pytest.raises(ValidationError):
        Platform(**fields | {"accuracy": {"altitude": value}})
