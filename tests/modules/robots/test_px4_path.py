"""The nominal path and the set-points that keep a vehicle on it."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vaso.modules.robots.px4_path import REACH, NominalPath
from vaso.platforms import get_platform

CORRECTION, MOST = 0.3, 0.9
PX4 = get_platform("px4")
speeds = st.integers(-4, 4).map(lambda n: n / 4)
velocities = st.tuples(speeds, speeds, speeds)


def flown(path: NominalPath, velocity: tuple[float, float, float], step: float = 0.05) -> None:
    path.begin(velocity, 1.0)
    while path.left > 0:
        path.advance(step)


@given(st.lists(velocities, max_size=12))
def test_the_altitude_is_that_of_the_model(plan: list[tuple[float, float, float]]) -> None:
    path, state = NominalPath(CORRECTION, MOST), PX4.dynamics.initial()
    for velocity in plan:
        flown(path, velocity)
        state = PX4.dynamics.step(state, PX4.commands[0].issue((velocity,), {}))
        assert path.altitude == pytest.approx(state.altitude, abs=1e-9)


@given(st.lists(velocities, max_size=12), st.floats(0.01, 0.3))
def test_the_path_does_not_depend_on_the_ticks(
    plan: list[tuple[float, float, float]], step: float
) -> None:
    one, other = NominalPath(CORRECTION, MOST), NominalPath(CORRECTION, MOST)
    for velocity in plan:
        flown(one, velocity)
        flown(other, velocity, step)
        assert one.position == other.position


def test_the_ground_carries_a_vehicle_that_does_not_climb() -> None:
    path = NominalPath(CORRECTION, MOST)
    flown(path, (0.5, 0.0, 0.0))
    assert path.position == (0.0, 0.0, 0.0) and path.stands


@given(st.tuples(*[st.floats(-20, 20)] * 3), velocities, st.integers(0, 20))
def test_corrections_are_bounded(
    measured: tuple[float, float, float], velocity: tuple[float, float, float], ticks: int
) -> None:
    path = NominalPath(CORRECTION, MOST)
    flown(path, (0.0, 0.0, -1.0))
    path.begin(velocity, 1.0)
    for _ in range(ticks):
        path.advance(0.05)
    setpoint = path.setpoint(measured)
    if setpoint.velocity is not None:
        speed = math.hypot(*setpoint.velocity)
        assert speed <= max(MOST, math.hypot(*velocity)) + 1e-9
        assert math.dist(setpoint.velocity, velocity) <= 2 * CORRECTION + 1e-9
    else:
        assert setpoint.position is not None
        assert math.dist(setpoint.position, measured) <= REACH + 1e-9


def test_a_vehicle_with_the_expected_lag_needs_no_correction() -> None:
    """Exponential lag of 0.5 s: along the whole leg the set-point is the plan's velocity."""
    path = NominalPath(CORRECTION, MOST)
    flown(path, (0.0, 0.0, -1.0))
    for _ in range(200):
        path.settle(0.05)
    path.begin((0.5, 0.0, 0.0), 1.0)
    time = 0.0
    while path.left > 0:
        path.advance(0.01)
        time += 0.01
        late = 0.5 * (time - 0.5 * (1 - math.exp(-time / 0.5)))
        if path.left > 0:
            setpoint = path.setpoint((late, 0.0, -1.0))
            assert setpoint.velocity == pytest.approx((0.5, 0.0, 0.0), abs=0.01)


def test_standing_still_is_a_position() -> None:
    path = NominalPath(CORRECTION, MOST)
    flown(path, (0.0, 0.0, -1.0))
    path.begin((0.0, 0.0, 0.0), 1.0)
    assert path.setpoint((0.2, -0.1, -0.9)).position == pytest.approx((0.0, 0.0, -1.0))
    far = path.setpoint((3.0, 0.0, -1.0)).position
    assert far == pytest.approx((3.0 - REACH, 0.0, -1.0))
