"""Recorded logs against rules: VASO's own, ROS messages, MAVLink telemetry, and broken files."""

from __future__ import annotations

import json

import pytest

from vaso import get_platform, load_skill
from vaso.cli import run as main
from vaso.errors import VasoError
from vaso.execution import IdealRobot, execute
from vaso.ltl import holds, parse
from vaso.monitoring import Truth
from vaso.monitoring.recorded import check_log, read_recording
from vaso.verdict import Verdict

DRIVE = load_skill("drive")
SQUARE = load_skill("fly-in-square-shape-traj")
BLIND = "for i in range(5):\n    forward()\nset_velocity(0.8, 0.0)\nstop()\n"


def statuses(report) -> dict[str, tuple[str, int | None]]:
    return {s.rule.text: (s.truth.value, s.step) for s in report.rules}


def write(path, lines) -> str:
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return str(path)


# ------------------------------------------------------------------------------------ own logs


@pytest.fixture
def run_log(tmp_path):
    robot = IdealRobot(
        get_platform("jackal"), lambda sensor, step: "people" in sensor and step == 2
    )
    execute(DRIVE, BLIND, robot, log=tmp_path / "run.jsonl")
    return tmp_path / "run.jsonl"


def test_a_violation_of_a_run_is_a_counterexample_and_a_gradient(run_log):
    report = check_log(run_log, "drive")
    assert statuses(report) == {
        "G(people_observed -> X stop)": ("violated", 3),
        "G(obstacle_observed -> X !forward)": ("open", None),
        "G(speed < 0.5)": ("violated", 6),
        "F(!people_observed & !obstacle_observed) -> F(!stop)": ("satisfied", 1),
    }
    assert report.verdict is Verdict.FAIL and not report
    for status in report.violated:
        example = report.counterexamples[status.rule]
        assert example.recorded and example.decided_at == status.step == len(example.steps) - 1
        labels = [s.labels for s in example.steps]
        for loop in range(len(labels)):  # whatever comes after the prefix
            assert not holds(parse(example.formula), labels, loop)
    text = str(report.gradient())
    assert "violates G(people_observed -> X stop), recorded on the robot" in text
    assert "Line 2 executes forward()" in text or "forward() of line 2" in text
    assert "does not read" not in text, "a recording does not say what was read"
    assert "back to step" not in text and "recorded on the robot up to this step" in text
    assert [s.verdict for s in report.result().specs] == [
        Verdict.FAIL,
        Verdict.UNKNOWN,
        Verdict.FAIL,
        Verdict.PASS,
    ]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "state 3: velocity_publisher is called without 'linear'"),
        ({"linear": [1.0], "angular": 0.0}, "state 3: velocity_publisher: linear must be a number"),
    ],
)
def test_a_command_that_does_not_take_its_arguments_is_an_error(run_log, arguments, message):
    lines = [json.loads(line) for line in run_log.read_text().splitlines()]
    lines[4]["arguments"] = arguments
    with pytest.raises(VasoError, match=message):
        check_log(write(run_log, lines), DRIVE)


def test_what_has_not_come_about_is_open(tmp_path):
    execute(DRIVE, "stop()", IdealRobot(get_platform("jackal")), log=tmp_path / "run.jsonl")
    report = check_log(tmp_path / "run.jsonl", DRIVE)
    last = report.rules[-1]
    assert last.truth is Truth.OPEN and [str(f) for f in last.awaited] == ["!stop"]
    assert report.verdict is Verdict.UNKNOWN and report.gradient() is None


def test_the_measured_number_counts(tmp_path):
    """The model believes 3 m; the altimeter says 10.2 m."""
    execute(
        SQUARE,
        "vel_traj = [(0.0, 0.0, -1.0)] * 3",
        IdealRobot(get_platform("px4")),
        log=tmp_path / "a",
    )
    lines = [json.loads(line) for line in (tmp_path / "a").read_text().splitlines()]
    lines[-2]["measured"]["altitude"] = 10.2
    assert statuses(check_log(write(tmp_path / "b", lines), SQUARE))["G(altitude < 10)"] == (
        "violated",
        3,
    )


def test_a_log_of_another_platform_is_refused(run_log):
    with pytest.raises(VasoError, match="from the platform jackal"):
        check_log(run_log, SQUARE)


# ---------------------------------------------------------------------------------------- ROS


def twist(t, linear, angular=0.0, *, stamped=False, topic="/cmd_vel"):
    inner = {"linear": {"x": linear, "y": 0, "z": 0}, "angular": {"x": 0, "y": 0, "z": angular}}
    return {"topic": topic, "t": t, "msg": {"header": {}, "twist": inner} if stamped else inner}


def as_string(t, *classes):
    data = {"detections": [{"class": c, "score": s} for c, s in classes]}
    return {"topic": "/detections", "t": t, "msg": {"data": json.dumps(data)}}


def as_array(t, *classes):
    found = [{"results": [{"hypothesis": {"class_id": c, "score": s}}]} for c, s in classes]
    return {"topic": "/yolo", "t": t, "msg": {"header": {}, "detections": found}}


def bag(detection, stops_at, *, score=0.9, stamped=False, scale=1.0):
    """Ten periods; a person in view from the sixth on."""
    for k in range(11):
        t = 50.0 + k * 0.1
        seen = [("person", score)] if k >= 6 else []
        yield detection((t - 0.02) * scale, *seen) | {}
        yield twist(t * scale, 0.0 if k >= stops_at else 0.3, stamped=stamped)


@pytest.mark.parametrize("detection", [as_string, as_array])
@pytest.mark.parametrize("stamped", [False, True])
def test_ros_messages(tmp_path, detection, stamped):
    rule = "G(people_observed -> X stop)"
    good = write(tmp_path / "good", bag(detection, 7, stamped=stamped))
    assert statuses(check_log(good, DRIVE))[rule] == ("open", None)
    bad = write(tmp_path / "bad", bag(detection, 9, stamped=stamped))
    assert statuses(check_log(bad, DRIVE))[rule] == ("violated", 8)
    unsure = write(tmp_path / "unsure", bag(detection, 99, score=0.3, stamped=stamped))
    assert statuses(check_log(unsure, DRIVE))[rule] == ("open", None)


def test_a_json_array_and_nanoseconds(tmp_path):
    messages = list(bag(as_string, 9))
    for message in messages:
        message["t"] = int((message["t"] + 1.7e9) * 1e9)
    (tmp_path / "bag.json").write_text(json.dumps(messages))
    report = check_log(tmp_path / "bag.json", DRIVE)
    assert statuses(report)["G(people_observed -> X stop)"] == ("violated", 8)
    assert "In step 8 velocity_publisher(linear=0.3, angular=0.0) is in force" in str(
        report.gradient()
    )


def test_without_a_detector_rules_about_people_are_not_decided(tmp_path):
    log = write(tmp_path / "log", [twist(k * 0.1, 0.6) for k in range(5)])
    report = check_log(log, DRIVE)
    assert statuses(report)["G(speed < 0.5)"] == ("violated", 1)
    assert report.rules[0].unknown == ("people_observed",)


def test_the_skill_says_what_else_is_observed(tmp_path):
    skill = load_skill("find-object")
    lines = [
        m
        for k in range(8)
        for m in (as_string(k * 0.1 - 0.02, ("chair", 0.9)), twist(k * 0.1, 0.2))
    ]
    log = write(tmp_path / "log", lines)
    rule = "G(target_observed -> X G stop)"
    assert statuses(check_log(log, skill))[rule] == ("open", None)
    assert statuses(check_log(log, skill, settings={"TARGET": "chair"}))[rule][0] == "violated"


def test_other_texts_are_no_detections(tmp_path, capsys):
    other = [{"topic": "/robot_description", "t": 1.0, "msg": {"data": "<robot/>"}}]
    other += [{"topic": "/status", "t": 1.1, "msg": {"data": '{"battery": 12.1}'}}]
    log = write(tmp_path / "log", [twist(1.0, 0.3), *other])
    assert check_log(log, DRIVE).rules[0].unknown == ("people_observed",)
    assert main(["trace", log, "--skill", "drive", "--detections-topic", "/status"]) == 2
    assert "a detection has no class" in capsys.readouterr().err


def test_odometry_is_what_was_measured(tmp_path):
    def odometry(t, speed):
        twist = {"twist": {"linear": {"x": speed}, "angular": {"z": 0.0}}}
        return {"topic": "/odom", "t": t, "msg": {"pose": {}, "twist": twist}}

    lines = [m for k in range(6) for m in (odometry(k * 0.1, 0.55), twist(k * 0.1, 0.3))]
    report = check_log(write(tmp_path / "log", lines), DRIVE)
    assert statuses(report)["G(speed < 0.5)"][0] == "violated"


# ------------------------------------------------------------------------------------- MAVLink


def flight(top, *, noise=0.02, setpoints=True):
    """Up to a height at 0.5 m/s, down again; armed in between. 10 Hz."""
    climb = round(top / 0.05)
    for k in range(2 * climb + 60):
        t, on = k * 0.1, 10 <= k < 2 * climb + 50
        up = 0.5 if 20 <= k < 20 + climb else -0.5 if 30 + climb <= k < 30 + 2 * climb else 0.0
        height = 0.05 * max(0, min(k - 19, climb, 30 + 2 * climb - k))
        wobble = noise * (-1) ** k
        boot = {"time_boot_ms": 1000 + 100 * k}
        if k % 10 == 0:
            mode = {"type": 2, "autopilot": 12, "base_mode": 129 if on else 1, "custom_mode": 0}
            yield "HEARTBEAT", t, mode
            yield "HEARTBEAT", t, {**mode, "type": 6, "base_mode": 0}  # the ground station
        yield "LOCAL_POSITION_NED", t, boot | {
            "x": 0.0, "y": 0.0, "z": 1.5 - height + wobble, "vx": wobble, "vy": 0.0, "vz": -up,
        }  # fmt: skip
        if setpoints:
            mask = {"type_mask": 0x0DC7, "vx": 0.0, "vy": 0.0, "vz": -up, "x": 0, "y": 0, "z": 0}
            yield "SET_POSITION_TARGET_LOCAL_NED", t, boot | mask
        yield "ATTITUDE", t, {"roll": 0.0}


SHAPES = {
    "to_dict": lambda name, t, fields: {"mavpackettype": name, **fields},
    "flight log": lambda name, t, fields: {"t": t, "type": name, **fields},
    "mavlogdump": lambda name, t, fields: {
        "meta": {"type": name, "timestamp": 1.7e9 + t},
        "data": fields,
    },
}


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_telemetry(tmp_path, shape):
    low = write(tmp_path / "low", [shape(*m) for m in flight(5.0)])
    report = check_log(low, SQUARE)
    assert report.verdict is Verdict.PASS, statuses(report)
    landing = "F(altitude > 0 & F(linear_velocity == 0 & altitude == 0))"
    assert statuses(report)[landing][0] == "satisfied" and statuses(report)[landing][1] > 15
    high = write(tmp_path / "high", [shape(*m) for m in flight(11.0)])
    truth, step = statuses(check_log(high, SQUARE))["G(altitude < 10)"]
    assert truth == "violated" and 20 <= step <= 23


def test_a_landing_without_set_points(tmp_path):
    """PX4 lands by itself when nobody sends set-points any more."""
    messages = [m for m in flight(5.0) if m[0] != "SET_POSITION_TARGET_LOCAL_NED" or m[1] < 14]
    report = check_log(write(tmp_path / "log", [SHAPES["to_dict"](*m) for m in messages]), SQUARE)
    assert report.verdict is Verdict.PASS, statuses(report)


def test_a_table_of_positions(tmp_path):
    rows = [
        "timestamp,LOCAL_POSITION_NED.z,LOCAL_POSITION_NED.vx,LOCAL_POSITION_NED.vy,LOCAL_POSITION_NED.vz"
    ]
    for name, t, m in flight(11.0):
        if name == "LOCAL_POSITION_NED":
            rows.append(f"{t},{m['z']},{m['vx']},{m['vy']},{m['vz']}")
    (tmp_path / "log.csv").write_text("\n".join(rows))
    report = check_log(tmp_path / "log.csv", SQUARE)
    assert statuses(report)["G(altitude < 10)"][0] == "violated"
    assert {s.rule.text for s in report.undecided} == {"G(velocity_change <= 1)"}


def test_a_flight_that_is_not_over(tmp_path):
    messages = [SHAPES["to_dict"](*m) for m in flight(5.0)]
    report = check_log(write(tmp_path / "log", messages[: len(messages) // 2]), SQUARE)
    assert report.verdict is Verdict.UNKNOWN
    assert "altitude > 0" in str(report.undecided[0].awaited[0]) or report.undecided[0].waits


# -------------------------------------------------------------------------------- broken files

POSITION = {"mavpackettype": "LOCAL_POSITION_NED", "t": 1.0, "z": 0, "vx": 0, "vy": 0, "vz": 0}
TWIST = twist(1.0, 0.3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("[]", "is empty"),
        ("[1, 2]", "element 0: 1 is no record"),
        ("hello\nworld\n", "neither JSON nor a table"),
        ("{]\n{}\n", ":1: no JSON"),
        ("[{}", ":1: no JSON"),
        ('{"a": 1}\n', ":1: this is no log"),
        (json.dumps(TWIST) + "\n17\n{}\n", ":2: 17 is no record"),
        (json.dumps(TWIST) + "\n{oops\n{}\n", ":2: no JSON"),
        (json.dumps(TWIST) + '\n{"topic": "/x", "msg": {}}\n', ":2: this is no message"),
        (json.dumps(TWIST | {"t": "now"}), ":1: its time is \"now\""),
        (json.dumps(TWIST | {"t": 1e400}), ":1: its time is inf"),
        (json.dumps(TWIST | {"msg": {"linear": {}, "angular": {}}}), ":1: a velocity is incomplete"),
        (json.dumps({"topic": "/yolo", "t": 1.0, "msg": {"data": "person!"}}), ":1: the text of a detector"),
        (json.dumps(as_string(1.0)), "no velocity commands"),
        (json.dumps(TWIST) + "\n" + json.dumps(twist(1.0, 0.1, topic="/b")), "several topics"),
        (json.dumps(POSITION | {"z": None}), ":1: LOCAL_POSITION_NED.z is null"),
        (json.dumps({k: v for k, v in POSITION.items() if k != "vz"}), "has no vz"),
        (json.dumps({k: v for k, v in POSITION.items() if k != "t"}), "has no time"),
        (json.dumps(POSITION | {"mavpackettype": "ATTITUDE"}), "no LOCAL_POSITION_NED"),
        (json.dumps(TWIST) + "\n" + json.dumps(twist(1.0e17, 0.3)), "the log spans 1e+08 s"),
        (json.dumps(POSITION) + "\n" + json.dumps(POSITION | {"t": 1e9}), "the log spans 1e+09 s"),
        ('{"kind": "run"}\n', ":1: not a line of a log"),
        ("[" * 100_000, "no JSON"),
    ],
)  # fmt: skip
def test_a_broken_log_gives_one_message_with_its_place(tmp_path, text, message, capsys):
    path = tmp_path / "log.json"
    path.write_text(text)
    skill = "fly-in-square-shape-traj" if "mavpackettype" in text else "drive"
    assert main(["trace", str(path), "--skill", skill]) == 2
    said = capsys.readouterr()
    assert message in said.err.replace("\n", " ") or message in said.err
    assert "Traceback" not in said.err and not said.out


def test_other_files(tmp_path, capsys):
    (tmp_path / "bin").write_bytes(bytes(range(256)))
    for path in (tmp_path / "bin", tmp_path, tmp_path / "none"):
        assert main(["trace", str(path), "--skill", "drive"]) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_a_log_that_was_cut_off_can_be_read(tmp_path):
    text = "".join(json.dumps(m) + "\n" for m in bag(as_string, 9))
    (tmp_path / "log").write_text(text[:-20])
    assert len(read_recording(tmp_path / "log", get_platform("jackal")).samples) > 5


# ------------------------------------------------------------------------------ command line


def test_the_command(run_log, tmp_path, capsys):
    page = tmp_path / "out.html"
    assert main(["trace", str(run_log), "--skill", "drive", "--html", str(page)]) == 1
    said = capsys.readouterr().out
    assert "2 of 4 rules violated" in said and "The robot did this:" in said
    assert "for ever" not in said
    assert "violated in step 3" in page.read_text()
    assert main(["trace", str(run_log), "--skill", "drive", "--json"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert data["verdict"] == "fail" and data["rules"][0]["counterexample"]["recorded"] is True
    assert main(["trace", str(run_log), "--skill", "drive", "--gradient", "verdict"]) == 1
    assert capsys.readouterr().out.startswith("violates G(people_observed -> X stop)")
    assert main(["trace", str(run_log), "--skill", "drive", "--set", "x"]) == 2
