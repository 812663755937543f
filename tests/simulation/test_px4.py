import math
from itertools import pairwise

import pytest
from driving import NED, fly, fly_on
from hypothesis import given, settings
from hypothesis import strategies as st

from vaso.dynamics.decay import Decay
from vaso.errors import RobotError
from vaso.execution import Robot
from vaso.platforms import Issued
from vaso.simulation import AirScene, Body, PX4Sim, Wind
from vaso.simulation.autopilot import Tracker

STILL_AIR = {"take_off": False, "body": Body(drag=(0.0, 0.0))}
"""Nothing but the response to set-points."""

BREEZE = AirScene(wind=Wind(mean=(2.0, 1.0, 0.0), gusts=0.7))
UP, STAY, DOWN = (0.0, 0.0, -0.5), (0.0, 0.0, 0.0), (0.0, 0.0, 0.5)
SQUARE = [
    (*UP, 10), STAY, (0.5, 0.0, 0.0, 8), STAY, (0.0, 0.5, 0.0, 8), STAY,
    (-0.5, 0.0, 0.0, 8), STAY, (0.0, -0.5, 0.0, 8), STAY, (*DOWN, 10), STAY,
]  # fmt: skip
SETPOINTS = st.lists(
    st.tuples(*[st.floats(-1.5, 1.5, allow_nan=False)] * 3, st.integers(1, 4)), max_size=6
)


def test_it_is_a_robot():
    assert isinstance(PX4Sim(), Robot)


def test_on_the_ground_nothing_moves_it_that_does_not_climb():
    robot = fly(PX4Sim(BREEZE), STAY, (1.0, 0.0, 0.0, 3), (0.0, 1.0, 0.5, 3))
    assert {(m.north, m.east, m.altitude, m.speed) for m in robot.truth.moments} == {(0, 0, 0, 0)}


def test_velocity_follows_set_points_as_the_platform_says():
    robot = fly(PX4Sim(tracking=False, **STILL_AIR), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0))
    up, along = Decay(0.25, math.inf, 1.0), Decay(0.56, math.inf, 1.0)
    first, second = robot.truth.moments[1:]
    assert first.altitude == pytest.approx(1.0 - up.area(1.0), abs=2e-3)
    assert second.velocity[0] == pytest.approx(1.0 - along.left(1.0), abs=2e-3)
    assert second.north == pytest.approx(1.0 - along.area(1.0), abs=2e-3)


def test_what_is_measured_is_what_the_platform_means():
    robot = fly(PX4Sim(tracking=False, **STILL_AIR), (0.0, 0.0, -1.0), (1.0, 0.0, -1.0, 2))
    found, here = robot.measured(), robot.truth.moments[-1]
    assert found["altitude"] == here.altitude == -found["z"]
    assert found["linear_velocity"] == pytest.approx(math.hypot(*here.velocity))
    assert found["velocity_change"] == 0.0
    assert fly_on(robot, (0.0, 0.0, -1.0)).measured()["velocity_change"] == 1.0
    assert set(found) >= {p.name for p in robot.platform.propositions}


def test_the_greatest_altitude_counts_between_samples_too():
    robot = PX4Sim(tracking=False, **STILL_AIR)
    fly(robot, (0.0, 0.0, -1.5, 4), (0.0, 0.0, 1.5))
    assert robot.truth.moments[-1].highest > max(m.altitude for m in robot.truth.moments) + 0.05
    assert robot.measured()["max_altitude"] == max(
        robot.truth.highest, *(altitude for *_, altitude in robot.truth.track)
    )


def test_drag_slows_legs_and_wind_pushes():
    leg = [(0.0, 0.0, -1.0, 4), (1.0, 0.0, 0.0, 10)]
    calm = fly(PX4Sim(tracking=False, take_off=False), *leg).truth.moments[-1]
    assert calm.velocity[0] == pytest.approx(1 / (1 + 0.56 * 0.1), abs=1e-3)
    blown = fly(PX4Sim(AirScene(wind=Wind(mean=(0, 3, 0))), tracking=False, take_off=False), *leg)
    drift = blown.truth.moments[-1].velocity[1]
    assert drift == pytest.approx(3 * 0.56 * 0.1 / (1 + 0.56 * 0.1), abs=1e-3)


def test_take_off_is_ramped():
    ramped = fly(PX4Sim(tracking=False), (0.0, 0.0, -1.0, 4)).truth.moments[-1]
    at_once = fly(PX4Sim(tracking=False, take_off=False), (0.0, 0.0, -1.0, 4)).truth.moments[-1]
    assert 0.7 < ramped.altitude < 1.4  # a real PX4 climbed 0.9 m
    assert at_once.altitude > 3.5


def test_the_nominal_path_waits_for_the_take_off():
    robot = fly(PX4Sim())
    robot.act(NED.issue((UP,), {}))
    period = robot.wait()
    assert period.overrun > 1.0 and period.seconds == pytest.approx(1.0 + period.overrun)
    assert period.time == period.seconds == robot.truth.moments[-1].time
    assert robot.truth.moments[-1].reference == pytest.approx((0.0, 0.0, 0.5))
    assert robot.measured()["altitude"] == pytest.approx(0.5, abs=0.3)
    robot.act(NED.issue((UP,), {}))
    assert robot.wait().overrun == 0
    assert robot.measured()["altitude"] == pytest.approx(1.0, abs=0.3)


def test_a_vehicle_that_cannot_take_off_is_told():
    stuck = AirScene(wind=Wind(mean=(0.0, 0.0, 60.0)))
    with pytest.raises(RobotError, match="has not climbed within 15 s"):
        fly(PX4Sim(stuck), UP)


@pytest.mark.parametrize("scene", [AirScene(), BREEZE], ids=["calm", "breeze"])
def test_a_tracked_square_returns_and_lands(scene):
    robot = fly(PX4Sim(scene, seed=2), *SQUARE)
    end = robot.truth.moments[-1]
    assert end.is_on_ground and end.altitude == 0 and robot.measured()["linear_velocity"] == 0
    assert math.dist(end.at, (0.0, 0.0)) < 0.4
    assert robot.truth.highest == pytest.approx(5.0, abs=0.3)
    for corner in ((4, 0), (4, 4), (0, 4)):
        assert min(math.dist(p, corner) for p in robot.truth.path) < 0.5
    assert max(m.speed for m in robot.truth.moments) <= 1.0


def test_the_same_square_flown_open_loop_drifts_by_metres():
    truth = fly(PX4Sim(BREEZE, seed=2, tracking=False), *SQUARE).truth
    assert math.dist(truth.moments[-1].at, (0.0, 0.0)) > 3.0
    assert truth.highest < 4.5


@settings(deadline=None)
@given(*[st.tuples(*[st.floats(-3, 3)] * 3)] * 2)
def test_corrections_are_bounded_and_lead_towards_the_path(setpoint, off):
    tracker = Tracker((0.0, 0.0, 5.0))
    wanted = tracker.steer(setpoint, (off[0], off[1], 5.0 + off[2]))
    assert math.hypot(*wanted) <= max(0.9, math.hypot(*setpoint)) + 1e-9
    slow = tracker.steer((0.2, 0.0, 0.0), (off[0], off[1], 5.0 + off[2]))
    correction = (slow[0] - 0.2, slow[1], slow[2])
    assert math.hypot(*correction) <= 0.3 + 1e-9
    assert correction[0] * off[0] + correction[1] * off[1] - correction[2] * off[2] <= 1e-9


def test_position_is_held_on_zero_velocity():
    robot = fly(PX4Sim(BREEZE, seed=1), (*UP, 8), (*STAY, 60))
    assert math.dist(robot.truth.moments[-1].at, (0.0, 0.0)) < 0.4
    assert robot.measured()["altitude"] == pytest.approx(4.0, abs=0.2)


@settings(max_examples=25, deadline=None)
@given(SETPOINTS, st.booleans())
def test_never_below_the_ground_nor_faster_than_asked_in_still_air(setpoints, tracking):
    robot = fly(PX4Sim(tracking=tracking), *setpoints)
    fastest = max((math.hypot(*s[:3]) for s in setpoints), default=0.0)
    for moment in robot.truth.moments:
        assert moment.altitude >= 0
        assert moment.speed <= max(fastest, 0.9) + 1e-6
        if moment.is_on_ground:
            assert moment.altitude == 0 and moment.speed == 0


@settings(max_examples=25, deadline=None)
@given(SETPOINTS)
def test_east_is_the_mirror_image_of_west(setpoints):
    east = fly(PX4Sim(), *setpoints).truth.moments
    west = fly(PX4Sim(), *((n, -e, d, k) for n, e, d, k in setpoints)).truth.moments
    for a, b in zip(east, west, strict=True):
        assert (a.north, a.east, a.altitude) == pytest.approx((b.north, -b.east, b.altitude))


@settings(max_examples=25, deadline=None)
@given(SETPOINTS)
def test_acceleration_is_limited(setpoints):
    body = Body(drag=(0.0, 0.0), horizontal=1.0, up=0.5, down=0.4)
    moments = fly(PX4Sim(tracking=False, take_off=False, body=body), *setpoints).truth.moments
    for a, b in pairwise(moments):
        if not a.is_on_ground and not b.is_on_ground:
            assert math.dist(a.velocity[:2], b.velocity[:2]) <= 1.0 + 1e-9
            assert -0.5 - 1e-9 <= b.velocity[2] - a.velocity[2] <= 0.4 + 1e-9


def test_touching_the_ground_is_recorded_with_its_speed():
    robot = fly(PX4Sim(tracking=False, **STILL_AIR), (0.0, 0.0, -1.0, 2), (0.0, 0.0, 1.0, 4))
    ((time, sink),) = robot.truth.touchdowns
    assert 4.25 < time < 4.75  # 4 s, the lag, and the time that it takes to turn round
    assert sink == pytest.approx(1.0, abs=0.01)


def test_a_second_take_off_is_ramped_as_well():
    robot = fly(PX4Sim(tracking=False), (*UP, 8), (*DOWN, 10))
    assert robot.truth.moments[-1].is_on_ground
    assert fly_on(robot, UP).measured()["altitude"] == 0.0
    assert fly_on(robot, (*UP, 4)).measured()["altitude"] > 0.5


def test_stop_lands_where_it_is():
    robot = fly(PX4Sim(BREEZE, seed=5), (*UP, 12), (0.5, 0.0, 0.0, 4))
    above = robot.truth.moments[-1]
    robot.stop("enough")
    end = robot.truth.moments[-1]
    assert end.is_on_ground and end.after_stop
    assert math.dist(end.at, above.at) < 1.0
    assert 0.6 < robot.truth.touchdowns[-1][1] < 0.8
    with pytest.raises(RobotError):
        robot.wait()


def test_gusts_have_the_strength_that_they_are_given():
    scene = AirScene(wind=Wind(mean=(1.0, 0.0, 0.0), gusts=1.5, time_scale=1.0))
    robot = fly(PX4Sim(scene, seed=1, take_off=False), (*STAY, 600))
    north = [m.wind[0] for m in robot.truth.moments]
    mean = sum(north) / len(north)
    spread = math.sqrt(sum((n - mean) ** 2 for n in north) / len(north))
    assert mean == pytest.approx(1.0, abs=0.3)
    assert spread == pytest.approx(1.5, abs=0.3)


def test_the_same_seed_is_the_same_flight_bit_for_bit():
    scene = AirScene(wind=Wind(mean=(2.0, 0.0, 0.0), gusts=0.7, spread=0.3))
    first = fly(PX4Sim(scene, seed=4), *SQUARE)
    again = first.truth
    assert fly(PX4Sim(scene, seed=4), *SQUARE).truth == again
    assert fly(first, *SQUARE).truth == again
    assert fly(PX4Sim(scene, seed=5), *SQUARE).truth != again


def test_the_take_off_point_moves_everything():
    robot = fly(PX4Sim(AirScene(take_off=(3.0, -2.0))), (*UP, 4), (0.5, 0.0, 0.0, 4), STAY)
    here = fly(PX4Sim(), (*UP, 4), (0.5, 0.0, 0.0, 4), STAY).truth.moments[-1]
    assert robot.truth.moments[-1].at == pytest.approx((3.0 + here.north, -2.0 + here.east))


@pytest.mark.parametrize(
    "command",
    [
        Issued(name="velocity_publisher", arguments=(("linear", 0.1), ("angular", 0.0))),
        Issued(name="set_velocity", arguments=(("velocity", (0.0, math.nan, 0.0)),)),
        Issued(name="set_velocity", arguments=(("velocity", (0.0, 0.0)),)),
        Issued(name="set_velocity", arguments=(("velocity", 1.0),)),
    ],
)
def test_bad_commands_are_refused(command):
    robot = fly(PX4Sim())
    with pytest.raises(RobotError):
        robot.act(command)


def test_it_has_no_sensors_and_does_nothing_before_the_start():
    with pytest.raises(RobotError, match="no sensor"):
        fly(PX4Sim()).read("yolo_listener('people')")
    robot = PX4Sim()
    robot.stop()
    with pytest.raises(RobotError, match="not been started"):
        robot.wait()
    robot.close()
    with pytest.raises(RobotError, match="closed"):
        robot.connect()
