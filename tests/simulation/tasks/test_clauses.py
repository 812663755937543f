"""Each kind of clause, on runs made for the purpose."""

import itertools
import math

import pytest
from pydantic import TypeAdapter, ValidationError

from vaso.simulation import AirScene, FlightMoment, FlightTruth, GroundMoment, GroundTruth, Scene
from vaso.simulation.tasks.task import AnyClause

CLAUSE = TypeAdapter(AnyClause)
DT = 0.1


def clause(kind, **fields):
    return CLAUSE.validate_python({"kind": kind, **fields})


def driven(points, *, scene=None, heading=0.0, turned=0.0, still=True, **changes):
    """A run along points, a moment each; it ends at rest, turned by some degrees."""
    moments = [
        GroundMoment(
            step=i,
            time=i * DT,
            x=x,
            y=y,
            heading=math.radians(heading + (turned if i == len(points) - 1 else 0)),
            linear=0.3,
            **{k: v[i] for k, v in changes.items()},
        )
        for i, (x, y) in enumerate(points)
    ]
    if still:
        moments[-1] = moments[-1].model_copy(update={"linear": 0.0})
    return GroundTruth(scene=scene or Scene(), seed=0, dt=DT, radius=0.3, moments=tuple(moments))


def line(*corners, step=0.1):
    """Points along straight legs."""
    points = [corners[0]]
    for a, b in itertools.pairwise(corners):
        count = max(1, round(math.dist(a, b) / step))
        points += [
            (a[0] + (b[0] - a[0]) * i / count, a[1] + (b[1] - a[1]) * i / count)
            for i in range(1, count + 1)
        ]
    return points


STRAIGHT = driven(line((0, 0), (3, 0)), turned=90)
ROOM = Scene.model_validate(
    {
        "furniture": [{"kind": "chair", "at": [2, 1]}],
        "doorways": [{"ends": [[3, -0.5], [3, 0.5]]}],
        "people": [{"path": [[5, 0]]}],
    }
)


@pytest.mark.parametrize(
    ("kind", "fields", "expected"),
    [
        ("ends_at", {"at": (3, 0), "within": 0.1}, True),
        ("ends_at", {"at": (3.2, 0), "within": 0.1}, False),
        ("passes", {"points": [(1, 0), (2, 0)], "within": 0.2}, True),
        ("passes", {"points": [(2, 0), (1, 0)], "within": 0.2}, False),
        ("passes", {"points": [(1, 1)], "within": 0.2}, False),
        ("turned", {"degrees": 90, "within": 1}, True),
        ("turned", {"degrees": -90, "within": 1}, False),
        ("turned", {"degrees": 450, "within": 1}, False),
        ("straight", {"within": 0.1}, True),
        ("travels", {"metres": 3, "within": 0.1}, True),
        ("travels", {"metres": 4, "within": 0.1}, False),
        ("advances", {"at_least": 2.9}, True),
        ("advances", {"at_least": 3.1}, False),
        ("stops", {}, True),
        ("turns_aside", {"at_least": 80}, True),
        ("turns_aside", {"at_least": 100}, False),
        ("clear", {}, True),
    ],
)
def test_the_way(kind, fields, expected):
    assert clause(kind, **fields).judge(STRAIGHT).is_true is expected


def test_points_are_relative_to_the_start():
    run = driven(line((5, 5), (5, 8)), heading=90)
    assert clause("ends_at", at=(3, 0), within=0.05).judge(run).is_true
    assert clause("straight", within=0.05).judge(run).is_true
    assert clause("advances", at_least=2.9).judge(run).is_true


def test_who_still_moves_has_not_stopped():
    assert not clause("stops").judge(driven([(0, 0), (1, 0)], still=False)).is_true


def test_what_comes_after_the_plan_does_not_count():
    run = driven(line((0, 0), (1, 0), (2, 0)), still=False, after_stop=[False] * 11 + [True] * 10)
    assert clause("ends_at", at=(1, 0), within=0.05).judge(run).is_true
    assert not clause("stops").judge(run).is_true


@pytest.mark.parametrize(
    ("kind", "fields", "expected"),
    [
        ("ends_at", {"place": "doorway", "within": 0.1}, True),
        ("near", {"what": "chair", "within": 1.5, "at_least": 1.0}, True),
        ("near", {"what": "chair", "within": 1.0}, False),
        ("near", {"what": "chair", "within": 2.0, "at_least": 1.8}, False),
        ("goes_by", {"what": "chair", "beyond": 0.5}, True),
        ("goes_by", {"what": "furniture", "beyond": 1.5}, False),
        ("faces", {"what": "doorway", "within": 10}, False),
    ],
)
def test_things(kind, fields, expected):
    run = driven(line((0, 0), (3.05, 0)), scene=ROOM, turned=45)
    assert clause(kind, **fields).judge(run).is_true is expected


def test_facing():
    run = driven([(2, 0), (2, 0)], scene=ROOM, turned=90)
    assert clause("faces", what="chair", within=5).judge(run).is_true


def test_near_a_person_is_near_where_that_person_is_now():
    people = [((5.0, 0.0),)] * 10 + [((2.0, 0.0),)]
    run = driven(line((0, 0), (1, 0)), scene=ROOM, people=people)
    assert clause("near", what="person", within=1.1).judge(run).is_true


def test_touching():
    run = driven(line((0, 0), (0.2, 0)), contact=["", "chair", ""])
    assert clause("clear").judge(run) == (False, "touches a chair after 0.1 s")
    assert clause("clear", of="person").judge(run).is_true


class TestFinds:
    def run(self, seen_from, still_from, count=40):
        seen = [{"bottle": i >= seen_from} for i in range(count)]
        run = driven(line((0, 0), (count * 0.1 - 0.1, 0)), in_view=seen)
        moments = [
            m.model_copy(update={"linear": 0.0}) if i >= still_from else m
            for i, m in enumerate(run.moments)
        ]
        return run.model_copy(update={"moments": tuple(moments)})

    def judge(self, *times):
        return clause("finds", what="bottle", delay=1).judge(self.run(*times)).is_true

    def test_stops_soon_after_it_comes_into_view(self):
        assert self.judge(20, 23)

    def test_late(self):
        assert not self.judge(10, 30)

    def test_goes_on_for_ever(self):
        assert not self.judge(20, 99)

    def test_never_in_view(self):
        assert not self.judge(99, 20)

    def test_who_never_moves_does_not_find(self):
        assert not self.judge(20, 0)


SQUARE = [(0, 0), (2, 0), (2, 2), (0, 2), (0, 0)]


@pytest.mark.parametrize(
    ("corners", "expected"),
    [
        (SQUARE, True),
        ([(y, x) for x, y in SQUARE], True),
        (SQUARE[:-1], False),
        ([(0, 0), (3, 0), (3, 2), (0, 2), (0, 0)], False),
        ([(0, 0), (2, 0), (1, 1.73), (0, 0)], False),
        ([(0, 0), (2, 0), (3, 1.73), (1, 1.73), (0, 0)], False),
    ],
)
def test_a_driven_square(corners, expected):
    run = driven(line(*corners))
    assert clause("square_path", side=2, within=0.4).judge(run).is_true is expected


def test_a_path_that_winds_without_end_is_no_square():
    spiral = [(0.01 * i * math.cos(i), 0.01 * i * math.sin(i)) for i in range(700)]
    assert not clause("square_path", side=2, within=9.0).judge(driven(spiral)).is_true


def flown(corners, *, speed=0.5, height=4.0, pause=1, landed=True, wobble=0.0, hover=1):
    """A flight at 1 Hz along corners (north, east), from the ground and back."""
    sets = [(0.0, 0.0, -0.5)] * round(height / 0.5) + [(0.0, 0.0, 0.0)] * hover
    for a, b in itertools.pairwise(corners):
        seconds = max(1, round(math.dist(a, b) / speed))
        sets += [((b[0] - a[0]) / seconds, (b[1] - a[1]) / seconds, 0.0)] * seconds
        sets += [(0.0, 0.0, 0.0)] * pause
    sets += [(0.0, 0.0, 0.5)] * (round(height / 0.5) if landed else 2) + [(0.0, 0.0, 0.0)]
    north, east = corners[0]
    up, track = 0.0, [(0.0, north, east, 0.0)]
    moments = [FlightMoment(step=0, time=0.0, north=north, east=east, altitude=0.0)]
    for second, (vn, ve, vd) in enumerate(sets):
        for tenth in range(1, 11):
            off = wobble * math.sin(second + tenth)
            at = (north + vn * tenth / 10, east + ve * tenth / 10, up - vd * tenth / 10)
            track.append((second + tenth / 10, at[0] + off, at[1] - off, at[2]))
        north, east, up = at
        moments.append(
            FlightMoment(
                step=second + 1,
                time=second + 1.0,
                north=north,
                east=east,
                altitude=up,
                velocity=(vn, ve, vd),
                setpoint=(vn, ve, vd),
                is_on_ground=up <= 0,
            )
        )
    return FlightTruth(
        scene=AirScene(), seed=0, dt=1.0, tracking=True, moments=tuple(moments), track=tuple(track)
    )


ROUND = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0)]  # north, then east: clockwise from above
MIDDLE = [(2, 0), (4, 0), (4, 4), (0, 4), (0, 0), (2, 0)]
TURNED = [(0, 0), (2.83, 2.83), (0, 5.66), (-2.83, 2.83), (0, 0)]


@pytest.mark.parametrize(
    ("corners", "fields", "expected"),
    [
        (ROUND, {"side": 4}, True),
        (ROUND, {}, True),
        (ROUND, {"side": 4, "sense": "clockwise"}, True),
        (ROUND, {"side": 4, "sense": "counterclockwise"}, False),
        (ROUND[::-1], {"side": 4, "sense": "counterclockwise"}, True),
        (ROUND, {"side": 3}, False),
        (MIDDLE, {"side": 4, "sense": "clockwise"}, True),
        (TURNED, {"side": 4}, True),
        (ROUND[:-1], {"side": 4}, False),
        ([(0, 0), (6, 0), (6, 4), (0, 4), (0, 0)], {}, False),
        ([(0, 0), (4, 0), (6, 3.46), (2, 3.46), (0, 0)], {}, False),
        ([(0, 0), (4, 0), (2, 3.46), (0, 0)], {}, False),
        ([(0, 0), (0, 0)], {}, False),
    ],
)
@pytest.mark.parametrize("wobble", [0.0, 0.15])
def test_a_flown_square(corners, fields, expected, wobble):
    found = clause("square", within=0.6, **fields).judge(flown(corners, wobble=wobble))
    assert found.is_true is expected, found.told


@pytest.mark.parametrize(
    ("kind", "fields", "flight", "expected"),
    [
        ("altitude", {"metres": 4, "within": 0.5}, {}, True),
        ("altitude", {"metres": 5, "within": 0.5}, {}, False),
        ("side_speed", {"mps": 0.5, "within": 0.1}, {}, True),
        ("side_speed", {"mps": 0.9, "within": 0.1}, {}, False),
        ("speed_below", {"mps": 0.8}, {}, True),
        ("speed_below", {"mps": 0.8}, {"speed": 1.0}, False),
        ("pauses", {"seconds": 1}, {}, True),
        ("pauses", {"seconds": 2}, {}, False),
        ("pauses", {"seconds": 2}, {"pause": 2}, True),
        ("pauses", {"seconds": 1}, {"pause": 0}, False),
        ("hovers_first", {"seconds": 1}, {}, True),
        ("hovers_first", {"seconds": 1}, {"hover": 0}, False),
        ("lands", {}, {}, True),
        ("lands", {}, {"landed": False}, False),
    ],
)
def test_flights(kind, fields, flight, expected):
    assert clause(kind, **fields).judge(flown(ROUND, **flight)).is_true is expected


def test_who_never_takes_off_does_not_land():
    assert not clause("lands").judge(flown([(0, 0), (0, 0)], height=0.0)).is_true


@pytest.mark.parametrize(
    "data",
    [
        {"kind": "ends_at", "within": 1},
        {"kind": "ends_at", "at": [1, 1], "place": "doorway", "within": 1},
        {"kind": "ends_at", "at": [1, 1], "within": -1},
        {"kind": "passes", "points": [], "within": 1},
        {"kind": "nothing"},
        {"kind": "stops", "maybe": True},
    ],
)
def test_what_is_no_clause(data):
    with pytest.raises(ValidationError):
        CLAUSE.validate_python(data)
