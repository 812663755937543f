import math
from itertools import pairwise

import pytest
from driving import OBSTACLE, PEOPLE, drive, go_on
from hypothesis import given, settings
from hypothesis import strategies as st

from vaso.errors import RobotError, SceneError
from vaso.execution import Robot
from vaso.platforms import Issued
from vaso.simulation import Camera, Detector, Furniture, Item, JackalSim, Person, Scene, Start

SEES = Detector.perfect()
COMMANDS = st.tuples(st.floats(-2, 2), st.floats(-4, 4), st.integers(1, 5))
ROOM = ((-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0), (-2.0, -2.0))


def jackal(scene=None, **options):
    return JackalSim(scene, **{"detector": SEES, "wheel_error": 0.0, **options})


def test_it_is_a_robot():
    assert isinstance(JackalSim(), Robot)


def test_at_rest_nothing_moves():
    robot = drive(jackal(wheel_error=0.1), (0.0, 0.0, 50))
    assert {(m.x, m.y, m.heading) for m in robot.truth.moments} == {(0.0, 0.0, 0.0)}
    assert robot.truth.path_length == 0


@settings(max_examples=50, deadline=None)
@given(st.floats(-4, 4), st.integers(1, 30))
def test_a_turn_on_the_spot_keeps_the_position(angular, periods):
    robot = drive(jackal(wheel_error=0.05), (0.0, angular, periods))
    assert {m.at for m in robot.truth.moments} == {(0.0, 0.0)}


def test_metres_and_degrees_are_those_of_the_commands():
    robot = drive(jackal(), (0.3, 0.0, 100), (0.0, 0.0, 5))
    assert robot.truth.moments[-1].x == pytest.approx(3.0, abs=1e-3)
    go_on(robot, (0.0, 0.5, 31), (0.0, 0.0, 5))
    assert robot.truth.turned == pytest.approx(0.5 * 3.1, abs=1e-3)


def test_driving_in_a_circle_is_driving_in_a_circle():
    robot = drive(jackal(), (0.3, 0.5, 1))
    start = robot.truth.moments[-1]
    go_on(robot, (0.3, 0.5, 40))
    end, turn = robot.truth.moments[-1], 0.5 * 4.0
    chord = 2 * (0.3 / 0.5) * math.sin(turn / 2)
    middle = start.heading + turn / 2
    assert end.x - start.x == pytest.approx(chord * math.cos(middle), abs=1e-6)
    assert end.y - start.y == pytest.approx(chord * math.sin(middle), abs=1e-6)


@settings(max_examples=50, deadline=None)
@given(st.lists(COMMANDS, max_size=8))
def test_left_is_the_mirror_image_of_right(commands):
    left = drive(jackal(), *commands).truth.moments
    right = drive(jackal(), *((v, -w, n) for v, w, n in commands)).truth.moments
    for a, b in zip(left, right, strict=True):
        assert (a.x, a.y, a.heading) == pytest.approx((b.x, -b.y, -b.heading), abs=1e-9)


@settings(max_examples=50, deadline=None)
@given(st.lists(COMMANDS, max_size=8))
def test_acceleration_and_speed_are_limited(commands):
    moments = drive(jackal(), *commands).truth.moments
    for a, b in pairwise(moments):
        assert abs(b.linear) <= 2.0 and abs(b.angular) <= 4.0
        assert abs(b.linear - a.linear) <= 20.0 * 0.1 + 1e-9
        assert abs(b.angular - a.angular) <= 25.0 * 0.1 + 1e-9
        assert math.dist(a.at, b.at) <= 0.1 * max(abs(a.linear), abs(b.linear)) + 0.02


def test_a_command_takes_effect_with_the_acceleration_of_the_platform():
    robot = drive(jackal(), (2.0, 0.0))
    assert robot.measured()["speed"] == pytest.approx(2.0)
    assert robot.measured()["x"] == pytest.approx(2.0 * 0.1 - 2.0**2 / (2 * 20.0))


@settings(max_examples=30, deadline=None)
@given(st.lists(COMMANDS, min_size=4, max_size=12), st.integers(0, 99))
def test_no_robot_ever_goes_through_a_wall_or_furniture(commands, seed):
    box = Furniture(kind="box", at=(1.0, 0.8), heading=20.0)
    scene = Scene(walls=(ROOM,), furniture=(box,), objects=(Item(kind="bin", at=(-1.0, -1.0)),))
    robot = drive(jackal(scene, seed=seed, wheel_error=0.02), *commands * 3)
    radius = robot.truth.radius
    for moment in robot.truth.moments:
        near = robot.world.near(moment.at, 9.0)
        assert robot.world.nearest(moment.at, near)[0] >= radius - 1e-9


def test_a_wall_stops_the_robot_and_is_recorded_and_the_robot_can_leave_it():
    robot = drive(jackal(Scene(walls=(ROOM,))), (0.5, 0.0, 60))
    here = robot.truth.moments[-1]
    assert here.linear == 0 and here.contact == "wall"
    assert here.x == pytest.approx(2.0 - robot.truth.radius, abs=0.02)
    go_on(robot, (-0.5, 0.0, 10))
    assert robot.truth.moments[-1].x < here.x - 0.4
    assert robot.truth.moments[-1].contact == ""


def test_starting_inside_something_is_told():
    with pytest.raises(SceneError, match="chair"):
        JackalSim(Scene(furniture=(Furniture(kind="chair", at=(0.3, 0.0)),)))


@pytest.mark.parametrize(
    "at, is_seen",
    [
        ((2.0, 0.0), True),
        ((2.0, 1.0), True),
        ((2.0, 2.0), False),
        ((2.0, -1.0), True),
        ((2.0, -2.0), False),
        ((-1.0, 0.0), False),
        ((6.5, 0.0), False),
    ],
)
def test_people_are_in_view_by_angle_and_distance(at, is_seen):
    robot = drive(jackal(Scene(people=(Person(path=(at,)),))))
    assert robot.read(PEOPLE) is is_seen
    assert robot.read("yolo_listener('person')") is is_seen


def test_walls_and_high_furniture_hide_people_and_chairs_do_not():
    person = Person(path=((3.0, 0.0),))
    for thing, is_seen in (
        (("shelf", False), False),
        (("box", None), True),
        (("chair", None), True),
    ):
        kind, opaque = thing
        piece = Furniture(kind=kind, at=(2.0, 0.0), heading=90.0, opaque=opaque or None)
        assert drive(jackal(Scene(people=(person,), furniture=(piece,)))).read(PEOPLE) is is_seen
    wall = ((1.5, -3.0), (1.5, 3.0))
    assert drive(jackal(Scene(people=(person,), walls=(wall,)))).read(PEOPLE) is False


def test_low_things_are_hidden_by_what_is_higher():
    bottle, box = Item(kind="bottle", at=(3.0, 0.0)), Furniture(kind="box", at=(2.0, 0.0))
    on_a_table = bottle.model_copy(update={"elevation": 0.75})
    assert not drive(jackal(Scene(objects=(bottle,), furniture=(box,)))).read(
        "yolo_listener('bottle')"
    )
    assert drive(jackal(Scene(objects=(on_a_table,), furniture=(box,)))).read(
        "yolo_listener('bottle')"
    )


@pytest.mark.parametrize(
    "asked, kind",
    [
        ("trash bin", "trash bin"),
        ("trash_can", "trash bin"),
        ("Trash Bins", "trash bin"),
        ("backpacks", "backpack"),
    ],
)
def test_things_are_known_by_their_usual_names(asked, kind):
    robot = drive(jackal(Scene(objects=(Item(kind=kind, at=(2.0, 0.0)),))))
    assert robot.read(f"yolo_listener({asked!r})") is True
    assert robot.read("yolo_listener('bottle')") is False


@pytest.mark.parametrize(
    "at, is_in_the_way",
    [
        ((0.9, 0.0), True),
        ((0.9, 0.5), True),
        ((0.9, 0.6), False),
        ((1.1, 0.0), False),
        ((-0.9, 0.0), False),
    ],
)
def test_an_obstacle_is_what_stands_in_the_strip_ahead(at, is_in_the_way):
    scene = Scene(objects=(Item(kind="trash bin", at=at, radius=0.15),))
    assert drive(jackal(scene)).read(OBSTACLE) is is_in_the_way


def test_walls_are_obstacles_and_people_are_not_unless_asked_for():
    assert drive(jackal(Scene(walls=(((0.7, -1.0), (0.7, 1.0)),)))).read(OBSTACLE)
    scene = Scene(people=(Person(path=((0.9, 0.0),)),))
    assert not drive(jackal(scene)).read(OBSTACLE)
    assert drive(jackal(scene, camera=Camera(people_are_obstacles=True))).read(OBSTACLE)


def test_a_person_walks_to_and_fro_with_pauses():
    person = Person(path=((2.0, 0.0), (2.0, 1.0)), speed=1.0, pause=0.5)
    moments = drive(jackal(Scene(people=(person,))), (0.0, 0.0, 40)).truth.moments
    heights = [m.people[0][1] for m in moments]
    assert heights[5] == pytest.approx(0.5)
    assert heights[10:16] == pytest.approx([1.0] * 6)
    assert heights[20] == pytest.approx(0.5)
    assert heights[25:31] == pytest.approx([0.0] * 6)


def test_a_person_can_leave():
    person = Person(path=((2.0, 0.0), (2.0, 1.0)), speed=1.0, then="leave")
    robot = drive(jackal(Scene(people=(person,))), (0.0, 0.0, 11))
    assert robot.truth.moments[-1].people == (None,)
    assert robot.read(PEOPLE) is False


def test_people_walk_around_a_robot_that_stands():
    person = Person(path=((-3.0, 0.0), (3.0, 0.0)), then="stay")
    robot = drive(jackal(Scene(people=(person,))), (0.0, 0.0, 120))
    assert robot.truth.moments[-1].people[0] == pytest.approx((3.0, 0.0))
    assert robot.truth.nearest_person == pytest.approx(0.15, abs=0.01)
    assert not robot.truth.contacts


def test_a_person_whose_way_point_the_robot_stands_on_goes_on_to_the_next():
    person = Person(path=((3.0, 0.0), (0.0, 0.0)), pause=0.5)
    robot = drive(jackal(Scene(people=(person,))), (0.0, 0.0, 60))
    ways = [m.people[0][0] for m in robot.truth.moments]
    assert min(ways) == pytest.approx(0.75, abs=0.1)
    assert max(ways[ways.index(min(ways)) :]) == pytest.approx(3.0)
    assert robot.truth.nearest_person >= 0.15 - 1e-9


def test_nobody_jumps_aside_for_a_fast_robot():
    person = Person(path=((3.0, 0.0), (0.5, 0.1)), speed=0.5, then="stay")
    robot = drive(jackal(Scene(people=(person,))), (2.0, 0.0, 20))
    spots = [m.people[0] for m in robot.truth.moments]
    assert all(math.dist(a, b) <= 0.15 + 1e-9 for a, b in pairwise(spots))
    assert robot.truth.contacts[0].contact == "person"


def test_people_who_wander_stay_in_their_area_and_off_the_furniture():
    table = Furniture(kind="table", at=(3.0, 0.0))
    scene = Scene(people=(Person(wander=((1.5, -2.0), (4.5, 2.0)), pause=0.0),), furniture=(table,))
    robot = drive(jackal(scene, seed=4), (0.0, 0.0, 300))
    spots = [m.people[0] for m in robot.truth.moments]
    assert all(1.5 <= x <= 4.5 and -2.0 <= y <= 2.0 for x, y in spots)
    assert len(set(spots)) > 200
    solid = next(s for s in robot.world.solids if s.name == "table")
    assert min(solid.distance(p) for p in spots) > 0.1


def test_a_robot_that_drives_into_a_person_is_stopped_and_it_is_recorded():
    robot = drive(jackal(Scene(people=(Person(path=((1.5, 0.0),)),))), (0.5, 0.0, 50))
    assert robot.truth.contacts[0].contact == "person"
    assert robot.truth.nearest_person == pytest.approx(0.0, abs=0.02)
    assert robot.truth.moments[-1].x < 1.0


def test_no_room_for_a_person_is_told():
    inside = Person(name="Bo", wander=((1.9, 0.1), (2.1, -0.1)))
    with pytest.raises(SceneError, match="no room for Bo"):
        JackalSim(Scene(people=(inside,), furniture=(Furniture(kind="bed", at=(2.0, 0.0)),)))


BUSY = Scene(
    robot=Start(spread=0.2, heading_spread=10.0),
    walls=(((-6.0, -6.0), (6.0, -6.0), (6.0, 6.0), (-6.0, 6.0), (-6.0, -6.0)),),
    people=(
        Person(wander=((1.0, -5.0), (5.0, 5.0))),
        Person(path=((2.0, 2.0), (2.0, -2.0)), spread=0.3, delay_spread=4.0),
    ),
)


def busy(seed, *sensors):
    robot = JackalSim(BUSY, seed=seed)
    robot.connect()
    robot.start()
    for _ in range(60):
        for sensor in sensors:
            robot.read(sensor)
        go_on(robot, (0.2, 0.1))
    return robot


def test_the_same_seed_is_the_same_run_bit_for_bit():
    assert busy(7, PEOPLE, OBSTACLE).truth == busy(7, PEOPLE, OBSTACLE).truth
    assert busy(7, PEOPLE).truth != busy(8, PEOPLE).truth


def test_start_begins_the_same_run_again():
    robot = busy(7, PEOPLE)
    first = robot.truth
    robot.start()
    for _ in range(60):
        robot.read(PEOPLE)
        go_on(robot, (0.2, 0.1))
    assert robot.truth == first


def test_what_is_read_changes_neither_people_nor_other_readings():
    many, few = busy(7, OBSTACLE, "yolo_listener('chair')", PEOPLE), busy(7, PEOPLE)
    assert [m.people for m in many.truth.moments] == [m.people for m in few.truth.moments]
    assert [m.reported.get("person") for m in many.truth.moments] == [
        m.reported.get("person") for m in few.truth.moments
    ]


def test_one_more_person_does_not_change_the_ways_of_the_others():
    more = BUSY.model_copy(update={"people": (*BUSY.people, Person(path=((5.0, 5.0),)))})
    alone, joined = JackalSim(BUSY, seed=3), JackalSim(more, seed=3)
    for robot in (alone, joined):
        drive(robot, (0.0, 0.0, 50))
    assert [m.people for m in alone.truth.moments] == [m.people[:2] for m in joined.truth.moments]


def test_readings_are_recorded_with_the_truth():
    robot = drive(jackal(Scene(people=(Person(path=((2.0, 0.0),)),)), detector=Detector(miss=1.0)))
    assert robot.read(PEOPLE) is False
    assert robot.truth.moments[0].in_view == {"person": True}
    assert robot.truth.moments[0].reported == {"person": False}
    assert robot.truth.first_in_view("person") is not None


@pytest.mark.parametrize(
    "command",
    [
        Issued(name="set_velocity", arguments=(("velocity", (0.0, 0.0, 0.0)),)),
        Issued(name="velocity_publisher", arguments=(("linear", math.nan), ("angular", 0.0))),
        Issued(name="velocity_publisher", arguments=(("linear", math.inf), ("angular", 0.0))),
    ],
)
def test_bad_commands_are_refused(command):
    robot = drive(jackal())
    with pytest.raises(RobotError):
        robot.act(command)


@pytest.mark.parametrize("sensor", ["lidar('x')", "yolo_listener(3)", "yolo_listener('a", "x"])
def test_unknown_sensors_are_refused(sensor):
    with pytest.raises(RobotError, match="no sensor"):
        drive(jackal()).read(sensor)


def test_stop_ends_motion_and_nothing_moves_before_the_start_or_after_it():
    robot = jackal()
    with pytest.raises(RobotError):
        robot.wait()
    robot.stop("not even started")
    drive(robot, (2.0, 0.0, 5))
    robot.stop("enough")
    assert robot.measured()["speed"] == 0
    assert robot.truth.moments[-1].after_stop
    with pytest.raises(RobotError):
        robot.wait()
    robot.close()
    with pytest.raises(RobotError, match="closed"):
        robot.start()
