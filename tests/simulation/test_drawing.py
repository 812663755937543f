import json
import re
from itertools import pairwise

import pytest
from driving import OBSTACLE, PEOPLE, fly, go_on

from vaso.errors import MissingDependencyError, VasoError
from vaso.execution import Header, Intervention, Record, RunLog
from vaso.simulation import (
    AirScene,
    Detector,
    Furniture,
    Item,
    JackalSim,
    Person,
    PX4Sim,
    Room,
    Scene,
    Wind,
    drawing,
)
from vaso.simulation.activity import activities, sightings
from vaso.simulation.logged import truth_of
from vaso.skill import Rule, Skill

ROOM = Scene(
    name="</script><b>room",
    rooms=(Room(name="lab", corners=((-1, -2), (4, 2))),),
    furniture=(Furniture(kind="chair", at=(2.0, 0.0)),),
    objects=(Item(kind="backpack", at=(1.0, 1.0)),),
    people=(Person(name="Ada", path=((3.0, -1.0), (3.0, 1.0))),),
)
SKILL = Skill(name="s", platform="px4", global_rules=(Rule(text="G(altitude < 10)"),))


@pytest.fixture(scope="module")
def drive():
    robot = JackalSim(ROOM, detector=Detector.perfect(), wheel_error=0.0)
    robot.connect()
    robot.start()
    for command in ((0.3, 0.0, 25), (0.0, 0.5, 20), (0.0, 0.0, 12), (-0.3, 0.0, 5), (1.0, 0.0, 40)):
        for _ in range(command[2]):
            robot.read(PEOPLE), robot.read(OBSTACLE)
            go_on(robot, command[:2])
    return robot


@pytest.fixture(scope="module")
def flight():
    scene = AirScene(wind=Wind(mean=(1.0, 0.5, 0.0), gusts=0.3))
    robot = PX4Sim(scene)
    fly(robot, (0.0, 0.0, -0.5, 6), (0.5, 0.0, 0.0, 4), (0.0, 0.0, 0.0), (0.0, 0.5, 0.0, 4))
    robot.stop()
    return robot


def log_of(robot, **changed):
    """A log as a run writes it, with one intervention in step 3."""
    said = Intervention(wanted="forward()", rule="G(p -> X stop)", reason="people are in view")
    records = [
        Record(
            step=m.step,
            time=m.time,
            command="c",
            api="forward()",
            line=7,
            intervention=said if m.step == 3 else None,
            **changed,
        )
        for m in robot.truth.moments
    ]
    header = Header(skill="drive", platform=robot.platform.name, robot="sim", dt=0.1, plan="")
    return RunLog(header=header, records=tuple(records))


def test_what_the_robot_did_is_told_without_gaps(drive):
    found = activities(drive.truth)
    assert [s.what for s in found] == [
        "drives",
        "turns left",
        "stands",
        "backs up",
        "drives",
        "touches",
    ]
    assert found[0].first == 0 and found[-1].last == len(drive.truth.moments) - 1
    assert all(a.last == b.first for a, b in pairwise(found))


def test_what_a_flight_did_is_told(flight):
    assert [s.what for s in activities(flight.truth)] == [
        "climbs",
        "flies",
        "hovers",
        "flies",
        "lands",
    ]


def test_sightings_are_when_the_detector_reported(drive):
    (first, *_) = sightings(drive.truth)["person"]
    assert first.first == 0
    assert all(m.reported["person"] for m in drive.truth.moments[1 : first.last + 1])


@pytest.mark.parametrize(
    "suffix, start", [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")]
)
def test_pictures_of_drives_and_flights_are_written(drive, flight, tmp_path, suffix, start):
    pytest.importorskip("matplotlib")
    for robot in (drive, flight):
        path = tmp_path / "deep" / f"run{suffix}"
        drawing.draw(log_of(robot), robot, picture=path, skill=SKILL)
        assert path.read_bytes().startswith(start)


def test_a_picture_names_what_is_on_it(drive, flight):
    pytest.importorskip("matplotlib")
    told = texts(drawing.picture(drive.truth, log_of(drive)))
    assert told >= {"chair", "backpack", "lab", "Ada", "start", "end", "people reported"}
    assert told >= {"drives", "turns left", "touches", "shield", "people's paths"}
    told = texts(drawing.picture(flight.truth, log_of(flight), skill=SKILL))
    assert told >= {"limit of the rules: 10 m", "climbs", "flies", "lands", "shield"}
    assert "limit of the rules: 10 m" not in texts(drawing.picture(flight.truth))


def texts(figure):
    import matplotlib.text

    return {t.get_text() for t in figure.findobj(matplotlib.text.Text)}


def test_an_animation_has_its_frames_and_duration(drive, flight, tmp_path):
    pytest.importorskip("matplotlib")
    from PIL import Image

    for robot, speed in ((drive, 8.0), (flight, 20.0)):
        path = tmp_path / "run.gif"
        drawing.save_animation(path, robot.truth, log_of(robot), speed=speed)
        with Image.open(path) as image:
            frames = robot.truth.moments[-1].time / speed * 10
            assert image.n_frames == pytest.approx(frames, abs=2.1)
            first = image.convert("RGB").tobytes()
            image.seek(image.n_frames - 1)
            assert image.convert("RGB").tobytes() != first


def test_a_page_needs_no_other_file_and_holds_the_run(drive, flight, tmp_path):
    for robot in (drive, flight):
        path = tmp_path / "run.html"
        drawing.draw(log_of(robot), robot, animation=path, skill=SKILL)
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"(src|href)=|url\(|@import|https?:", text)
        data = page_data(text)
        assert len(data["frames"]) == len(data["states"]) == len(robot.truth.moments)
        assert data["states"][3] == ["forward()", 7, "forward() replaced: people are in view"]
        assert data["states"][4] == ["forward()", 7, ""]


def test_names_cannot_break_out_of_a_page(drive):
    from vaso.simulation.page import page

    text = page(drive.truth, None, {}, drive.scene.name)
    assert "</script><b>" not in text
    assert page_data(text)["kind"] == "ground"


def page_data(text):
    return json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL).group(1))


def test_a_real_robot_s_log_is_drawn_from_what_was_measured(flight, tmp_path):
    records = [
        Record(
            step=m.step,
            time=m.time,
            command="set_velocity",
            arguments={"velocity": m.setpoint},
            measured={
                "x": m.north,
                "y": m.east,
                "altitude": m.altitude,
                "linear_velocity": m.speed,
            },
        )
        for m in flight.truth.moments
        if not m.after_stop
    ]
    header = Header(skill="s", platform="px4", robot="px4 at udp", dt=1.0, plan="")
    log = RunLog(header=header, records=tuple(records))
    truth = truth_of(log)
    assert truth.highest == pytest.approx(max(m.altitude for m in flight.truth.moments), abs=0.2)
    assert truth.moments[-1].at == flight.truth.moments[len(records) - 1].at
    assert truth.moments[-1].reference == pytest.approx(
        flight.truth.moments[len(records) - 1].reference
    )
    assert [m.speed for m in truth.moments[3:]] == pytest.approx(
        [m.speed for m in flight.truth.moments[3 : len(records)]]
    )
    drawing.draw(log, animation=tmp_path / "run.html")


def test_a_log_without_positions_cannot_be_drawn(drive, tmp_path):
    with pytest.raises(VasoError, match="no positions"):
        drawing.draw(log_of(drive), animation=tmp_path / "run.html")


@pytest.mark.parametrize("name", ["run.jpeg", "run", "run.gif"])
def test_unknown_kinds_of_pictures_are_told(drive, tmp_path, name):
    with pytest.raises(VasoError, match="cannot draw into"):
        drawing.draw(log_of(drive), drive, picture=tmp_path / name)


def test_a_missing_matplotlib_is_told(drive, tmp_path, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    monkeypatch.setattr("importlib.import_module", absent)
    with pytest.raises(MissingDependencyError, match="plots"):
        drawing.save_picture(tmp_path / "run.png", drive.truth)


def absent(name):
    raise ModuleNotFoundError(f"No module named {name!r}", name=name)


@pytest.mark.parametrize("make", [JackalSim, PX4Sim])
@pytest.mark.parametrize("name", ["run.png", "run.gif", "run.html"])
def test_a_run_that_ended_before_its_first_command_can_be_drawn(tmp_path, make, name):
    pytest.importorskip("matplotlib")
    robot = make()
    robot.connect()
    robot.start()
    where = "picture" if name == "run.png" else "animation"
    drawing.draw(log_of(robot), robot, **{where: tmp_path / name})
    assert (tmp_path / name).stat().st_size > 1000


def test_what_happened_survives_being_written(drive, flight):
    alone = JackalSim().truth  # the nearest person is infinitely far away
    for truth in (drive.truth, flight.truth, alone):
        assert type(truth).model_validate_json(truth.model_dump_json()) == truth


def test_limits_are_those_of_the_rules():
    rules = ("G(altitude < 10)", "G (linear_velocity <= 1)", "G(8 > altitude)", "F(speed < 1)")
    skill = Skill(name="s", platform="px4", global_rules=tuple(Rule(text=t) for t in rules))
    assert drawing.limits_of(skill) == {"altitude": 8.0, "linear_velocity": 1.0}
    assert drawing.limits_of(None) == {}
