"""Numbers between samples: the same rule at every second and at every instant."""

import json
import math

import pytest
from vehicle_simulation import Vehicle

from vaso import get_platform, load_skill, verify
from vaso.dynamics.rules import Invariant, invariant
from vaso.ltl import parse
from vaso.plan import Budget
from vaso.platforms import Channel, Position, Response, Speed
from vaso.verdict import Verdict

SQUARE = load_skill("fly-in-square-shape-traj")
DRIVE = load_skill("drive")


def flight(*legs):
    """A plan from legs (north, east, down, seconds)."""
    parts = [f"[({n!r}, {e!r}, {d!r})] * {s}" for n, e, d, s in legs]
    return f"vel_traj = {' + '.join(parts)}\n"


def with_response(lag=0.0, acceleration=math.inf):
    """The PX4, with another response."""
    channel = {"parameter": "velocity", "lag": lag, "acceleration": acceleration}
    return get_platform("px4").model_copy(
        update={
            "response": Response(
                channels=(
                    Channel(name="horizontal", components=(0, 1), **channel),
                    Channel(name="vertical", components=(2,), **channel),
                ),
                quantities={
                    "altitude": Position(channel="vertical", factor=-1.0, floor=0.0),
                    "linear_velocity": Speed(
                        channels=("horizontal", "vertical"), unless_on="altitude"
                    ),
                },
            )
        }
    )


def judge(plan, rule, platform=None, skill=SQUARE):
    """The verdict at the samples, and the one between them."""
    result = verify(skill, plan, specs=[rule], platform=platform)
    return result.specs[-1].verdict, next(b for b in result.between if b.spec == rule)


# --- the two verdicts are told apart -------------------------------------------------------------

UP_AND_DOWN = flight((0.0, 0.0, -1.0, 10), (0.0, 0.0, 1.0, 10))


def test_ten_metres_are_touched_at_a_sample_and_never_exceeded():
    sampled, inside = judge(UP_AND_DOWN, "G(altitude <= 10)", with_response())
    assert sampled is Verdict.PASS and inside.verdict is Verdict.PASS
    assert inside.bounds[0].greatest == pytest.approx(10.0, abs=1e-9)


def test_a_vehicle_that_cannot_brake_at_once_overshoots():
    # At 0.5 m/s2, a second of descending only slows it down, and the next second lifts it again.
    up, down, still = (0.0, 0.0, -1.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)
    plan = flight((*up, 10), (*down, 1), (*up, 1), (*still, 1))
    sampled, inside = judge(plan, "G(altitude <= 10)", with_response(acceleration=(0.5, 0.5)))
    assert sampled is Verdict.PASS
    assert inside.verdict is Verdict.FAIL, inside
    assert inside.witness.name == "altitude" and inside.witness.value > 10
    assert_witness_is_real(inside.witness, plan, (0.0, 0.0), (0.5, 0.5))


def assert_witness_is_real(witness, plan, lags, limits):
    """Fly the plan in small steps up to the witness."""
    names = {}
    exec(plan, names)
    vehicle, steps = Vehicle(lags, limits), 2000
    for index, velocity in enumerate(names["vel_traj"], start=1):
        last = index == witness.step
        share = witness.within if last else 1.0
        for _ in range(round(steps * share)):
            vehicle.follow(velocity, 1.0 / steps)
        if last:
            break
    assert vehicle.values[witness.name] == pytest.approx(witness.value, abs=0.01)


def test_a_fall_that_ends_before_the_sample_is_seen():
    plan = flight((0.0, 0.0, -1.0, 1), (0.0, 0.0, 3.0, 1), (0.0, 0.0, 0.0, 1))
    rule = "G(linear_velocity <= 1)"
    sampled, inside = judge(plan, rule, with_response())
    assert sampled is Verdict.PASS  # on the ground at the sample, where the speed counts as 0
    assert inside.verdict is Verdict.FAIL and inside.witness.step == 2
    assert inside.witness.value == pytest.approx(3.0)


def test_a_lag_keeps_what_was_commanded_for_some_time():
    sampled, inside = judge("forward()\nstop()\n", "G(stop -> speed == 0)", skill=DRIVE)
    assert sampled is Verdict.PASS
    assert inside.verdict is Verdict.FAIL and inside.witness.step == 2
    assert "acceleration of 20" in inside.text


def test_a_trigger_that_depends_on_sensors():
    plan = "while True:\n    stop() if people_observed() else forward()\n"
    sampled, inside = judge(plan, "G(people_observed -> X speed < 0.01)", skill=DRIVE)
    assert sampled is Verdict.PASS and inside.verdict is Verdict.FAIL
    sampled, inside = judge(plan, "G(people_observed -> X speed <= 0.3)", skill=DRIVE)
    assert sampled is Verdict.PASS and inside.verdict is Verdict.PASS


def test_a_loop_that_drifts_is_never_called_safe():
    # Too slow to follow, the vehicle rises half a metre every two seconds.
    legs = "vel_traj = [(0.0, 0.0, -1.0), (0.0, 0.0, 1.0)] * 30 + [(0.0, 0.0, 0.0)]\n"
    sampled, inside = judge(legs, "G(altitude <= 5)", with_response(acceleration=(0.5, 0.5)))
    assert sampled is Verdict.PASS and inside.verdict is Verdict.FAIL


def test_for_every_vehicle_of_the_class():
    plan = flight((0.0, 0.0, -1.0, 9), (0.0, 0.0, 0.0, 3))
    for lag in (0.1, 0.5, 2.0):
        sampled, inside = judge(plan, "G(altitude <= 9)", with_response(lag=lag))
        assert sampled is Verdict.PASS and inside.verdict is Verdict.PASS, inside
        assert f"at most {lag:g} s" in inside.vehicle


def test_where_the_bounds_do_not_decide_it_is_not_known():
    # Quick north and south, slow up and down: a little above 0.5 m/s for some vehicles only.
    sampled, inside = judge(SQUARE.plan_template, "G(linear_velocity <= 0.5)")
    assert sampled is Verdict.PASS
    assert inside.verdict is Verdict.UNKNOWN and "too wide" in inside.text


def test_a_plan_that_was_not_explored_to_its_end_is_not_known():
    endless = "n = 0\nwhile n == n:\n    n += 1\n    if str(n):\n        forward()\n"
    result = verify("drive", endless, budget=Budget(states=30))
    (inside,) = result.between
    assert inside.verdict is Verdict.UNKNOWN
    assert "explored up to step" in inside.reason


# --- the shipped skills --------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["drive", "bypass-object", "find-object"])
def test_the_shipped_speed_limit_holds_at_every_instant(name):
    skill = load_skill(name)
    [inside] = verify(skill, skill.plan_template).between
    assert inside.verdict is Verdict.PASS and inside.bounds[0].greatest == pytest.approx(0.3)


def test_the_shipped_square_stays_below_ten_metres():
    result = verify(SQUARE, SQUARE.plan_template)
    found = {b.spec: b for b in result.between}
    altitude = found["G(altitude < 10)"]
    assert altitude.verdict is Verdict.PASS
    assert altitude.text == (
        "altitude always stays below 10, inside every period too (altitude at most 5 m)"
    )
    assert found["G(linear_velocity <= 1)"].verdict is Verdict.PASS
    assert found["F(linear_velocity > 0)"].verdict is Verdict.UNSUPPORTED
    assert json.loads(json.dumps(result.to_json(), allow_nan=False))["between"][0]["bounds"][0][
        "greatest"
    ] == pytest.approx(5.0, abs=1e-6)


# --- what cannot be compared ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rule", "reason"),
    [
        ("F(altitude > 3)", "asks for a moment"),
        ("G(F(altitude > 3))", "asks for a moment"),
        ("(altitude < 3) U (altitude > 2)", "asks for a moment"),
        ("altitude < 10", "at single steps only"),
        ("X(altitude < 10)", "at single steps only"),
        ("G(altitude > 1 -> linear_velocity < 1)", "at the same instant"),
        ("G(stop <-> speed == 0)", "at the same instant"),
        ("G(Y(speed < 1))", "asks for a moment"),
    ],
)
def test_not_comparable(rule, reason):
    assert reason in invariant(parse(rule))


@pytest.mark.parametrize(
    "rule",
    [
        "G(altitude < 10)",
        "!F(altitude >= 10)",
        "G(a -> X(speed < 1))",
        "G(a) & G(b | speed < 1 & altitude < 3)",
        "F a -> G(speed < 1)",
    ],
)
def test_comparable(rule):
    assert isinstance(invariant(parse(rule)), Invariant)


def test_labelling_code_in_other_units_is_not_compared():
    feet = SQUARE.labelling_code.replace("    return z\n", "    return z * 3.28\n", 1)
    skill = SQUARE.with_parameters({"labelling_code": feet})
    _, inside = judge(SQUARE.plan_template, "G(altitude < 100)", skill=skill)
    assert inside.verdict is Verdict.UNSUPPORTED
    assert "the labelling code says that altitude is 1.64" in inside.reason


def test_a_platform_without_response_says_nothing():
    bare = get_platform("jackal").model_copy(update={"response": None})
    _, inside = judge("forward()\n", "G(speed < 1)", bare, DRIVE)
    assert inside.verdict is Verdict.UNSUPPORTED and "does not say" in inside.reason


def test_it_can_be_left_out():
    assert verify(DRIVE, "forward()\n", between=False).between == ()


def test_it_does_not_change_the_verdict_of_a_plan():
    plan = flight((0.0, 0.0, -1.0, 1), (0.0, 0.0, 3.0, 1), (0.0, 0.0, 0.0, 1))
    with_it, without = (
        verify(SQUARE, plan, specs=["G(linear_velocity <= 1)"], between=b) for b in (True, False)
    )
    assert [s.verdict for s in with_it.specs] == [s.verdict for s in without.specs]
    assert any(b.verdict is Verdict.FAIL for b in with_it.between)
