"""Bounds on a period contain every trajectory of every vehicle of the class."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from vehicle_simulation import Vehicle, response

from vaso.dynamics.period import Period, at_rest
from vaso.dynamics.vehicles import parts, whole

STEPS = 200
NEAR = 0.02  # what the steps get wrong, most of all in when the vehicle touches the ground
REST = ((0.0, 0.0), (0.0,))

speeds = st.sampled_from([-3.0, -1.0, -0.5, -0.1, 0.0, 0.0, 0.1, 0.5, 1.0, 2.0])
setpoints = st.lists(st.tuples(speeds, speeds, speeds), min_size=1, max_size=6)
lags = st.sampled_from([0.0, 0.05, 0.25, 0.6, 1.5])
limits = st.sampled_from([0.4, 1.0, 3.0, math.inf])
shares = st.floats(0.0, 1.0)
floors = st.sampled_from([0.0, 0.0, None])


def split(velocity):
    return (velocity[0], velocity[1]), (velocity[2],)


def assert_contained(found, values, where):
    for name, (low, high) in found.items():
        assert low - NEAR <= values[name] <= high + NEAR, (name, where, values[name], (low, high))


def follow(model, vehicle, flying, plan):
    box = at_rest(model, REST)
    for number, velocity in enumerate(plan):
        period = Period(model, vehicle, box, split(velocity))
        seen = [flying.values]
        for step in range(1, STEPS + 1):
            flying.follow(velocity, 1.0 / STEPS)
            seen.append(flying.values)
            if step % 25 == 0:
                at = step / STEPS
                assert_contained(period.values(at, at), seen[-1], (number, at))
        for begin, end in ((0.0, 1.0), (0.0, 0.25), (0.25, 1.0), (0.5, 0.75)):
            found = period.values(begin, end)
            for step in range(int(begin * STEPS) + 1, int(end * STEPS) + 1, 7):
                assert_contained(found, seen[step], (number, begin, end, step))
        box = period.end(1.0)


@settings(max_examples=60, deadline=None)
@given(
    setpoints,
    st.tuples(lags, lags),
    st.tuples(limits, limits),
    st.tuples(st.tuples(shares, shares), st.tuples(shares, shares)),
    floors,
    st.integers(0, 15),
)
def test_every_trajectory_is_inside(plan, lag, limit, chosen, floor, part):
    model = response(lag, limit, floor)
    cut = parts(model, {"horizontal", "vertical"})
    for vehicle in (whole(model), cut[part % len(cut)]):
        constants = []
        for known, (first, second) in zip(vehicle, chosen, strict=True):
            low, high = known.lags
            constants.append(
                (low + first * (high - low), known.accelerations[0] / max(second, 0.05))
            )
        flying = Vehicle(*zip(*constants, strict=True), floor=floor)
        follow(model, vehicle, flying, plan)


def test_with_known_constants_the_bounds_are_the_solution():
    model = response(((0.5, 0.5), (0.5, 0.5)))
    box = at_rest(model, REST)
    period = Period(model, whole(model), box, split((0.0, 0.0, -1.0)))
    height = 1.0 - 0.5 * (1 - math.exp(-2.0))  # by hand: t - lag * (1 - exp(-t / lag))
    assert period.values(1.0, 1.0)["altitude"] == pytest.approx((height, height), abs=1e-12)
    speed = 1 - math.exp(-2.0)
    assert period.values(1.0, 1.0)["linear_velocity"] == pytest.approx((speed, speed), abs=1e-12)


def test_the_error_of_a_lag_is_the_lag_times_the_change_of_speed():
    model = response(((0.5, 0.5), (0.5, 0.5)))
    box = at_rest(model, REST)
    for _ in range(40):
        box = Period(model, whole(model), box, split((0.0, 0.0, -1.0))).end(1.0)
    assert box.positions[0] == pytest.approx((40 - 0.5, 40 - 0.5), abs=1e-9)


def test_a_limited_acceleration_is_a_ramp():
    model = response((0.0, 0.0), (math.inf, (0.5, 0.5)))
    period = Period(model, whole(model), at_rest(model, REST), split((0.0, 0.0, -1.0)))
    assert period.values(1.0, 1.0)["altitude"] == pytest.approx((0.25, 0.25), abs=1e-12)
    assert period.values(1.0, 1.0)["sink"] == pytest.approx((-0.5, -0.5), abs=1e-12)


def test_for_ever():
    model = response(((0.5, 0.5), (0.5, 0.5)))
    rest = at_rest(model, REST)
    up = Period(model, whole(model), rest, split((0.0, 0.0, -1.0)))
    assert up.values(0.0, math.inf)["altitude"] == (0.0, math.inf)
    then = Period(model, whole(model), up.end(1.0), split((0.0, 0.0, 0.0)))
    low, high = then.values(0.0, math.inf)["altitude"]
    assert high == pytest.approx(1.0, abs=1e-9)  # it ends where the set-points lead
    assert low <= up.values(1.0, 1.0)["altitude"][0]


def test_a_vehicle_on_the_ground_stands_still():
    model = response((0.5, 0.5))
    period = Period(model, whole(model), at_rest(model, REST), split((2.0, 0.0, 1.0)))
    assert period.stands
    assert period.values(0.0, 1.0)["linear_velocity"] == (0.0, 0.0)
    assert period.end(1.0) == at_rest(model, REST)


def test_falling_to_the_ground_is_seen_before_the_sample():
    model = response((0.0, 0.0))
    up = Period(model, whole(model), at_rest(model, REST), split((0.0, 0.0, -1.0)))
    down = Period(model, whole(model), up.end(1.0), split((0.0, 0.0, 3.0)))
    assert down.values(1.0, 1.0)["linear_velocity"] == (0.0, 0.0)
    assert down.values(0.2, 0.2)["linear_velocity"] == pytest.approx((3.0, 3.0))


def test_rounding_does_not_lead_below_the_floor():
    # Otherwise a box that was widened to everything would not cover the next one, for ever.
    model = response((0.0, 0.4))
    box = at_rest(model, REST)
    for down in (-0.25, 0.25, 0.25, 0.25):
        box = Period(model, whole(model), box, split((0.0, 0.0, down))).end(0.5)
        assert box.aims[0][0] >= 0.0 and box.highest[0][0] >= 0.0 and box.positions[0][0] >= 0.0
