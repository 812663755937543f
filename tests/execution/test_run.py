"""Runs are paths of the automaton that was verified, and every ending stops the robot."""

from __future__ import annotations

import errno
import random
from types import SimpleNamespace

import numpy
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vaso import compile_plan, get_platform, load_skill
from vaso.errors import PlanError, RobotError, StaleReadingError, VasoError
from vaso.execution import IdealRobot, Intervention, execute, read_log
from vaso.execution.record import Writer

DRIVE = load_skill("drive")
SQUARE = load_skill("fly-in-square-shape-traj")
JACKAL = get_platform("jackal")

PLANS = [
    "while True:\n    stop() if people_observed() else forward()\n",
    "for _ in range(4):\n    while people_observed() or obstacle_observed():\n        stop()\n"
    "    forward()\nstop()\n",
    "start = time.time()\npaused = 0.0\nwhile (time.time() - start) - paused < 0.5:\n"
    "    if people_observed():\n        before = time.time()\n        stop()\n"
    "        paused += time.time() - before\n    else:\n        forward()\n",
    "forward()\ntime.sleep(0.35)\nif obstacle_observed():\n    turn_left()\nelse:\n    backward()\n",
    "seen = [people_observed(), people_observed()]\nif seen[0] == seen[1]:\n    forward()\n"
    "raise SystemExit\n",
    "while not people_observed():\n    pass\nforward()\n",
    "velocity_publisher(0.2, 0.1)\nvelocity_publisher(0.0, 0.0)\n",
]


def path_of(system, log):
    """The control states that the readings of a run lead through."""
    state, found = 0, []
    for record in log.records:
        found.append(state)
        full = {s.name: record.sensors.get(s.name, s.domain[0]) for s in system.sensors}
        labels = system.states[state].label(full)
        for name, value in record.labels.items():
            assert labels[name] == pytest.approx(value), (record.step, name)
        assert str(system.states[state].command).startswith(record.command)
        if not system.edges[state]:
            break
        state = system.step(state, full).target
    return found


@pytest.mark.parametrize("source", PLANS)
@given(seed=st.integers(0, 10_000))
@settings(max_examples=8, deadline=None)
def test_a_run_is_a_path_of_the_verified_automaton(source, seed):
    system = compile_plan(source, DRIVE)
    dice = random.Random(seed)
    values = {}

    def sense(sensor, state):
        return values.setdefault((sensor, state), dice.random() < 0.4)

    log = execute(DRIVE, source, IdealRobot(JACKAL, sense), seconds=3)
    assert log.ending.outcome in ("finished", "stopped")
    assert len(path_of(system, log)) == len(log.records)


@pytest.mark.parametrize("skill", [DRIVE, SQUARE], ids=lambda s: s.name)
def test_the_shipped_templates_run_to_their_end(skill):
    robot = IdealRobot(get_platform(skill.platform))
    log = execute(skill, skill.plan_template, robot)
    assert log.ending.outcome == "finished" and log.ending.reason == ""
    assert robot.stopped == [""]
    system = compile_plan(skill.plan_template, skill)
    assert len(path_of(system, log)) == len(log.records) > 20


def test_the_log_on_disk_is_the_log(tmp_path):
    file = tmp_path / "runs" / "log.jsonl"
    log = execute(SQUARE, SQUARE.plan_template, IdealRobot(get_platform("px4")), log=file)
    assert read_log(file) == log
    text = file.read_text()
    file.write_text(text[: text.rindex('"kind"')])  # a process that was lost in mid-line
    assert read_log(file).ending is None and len(read_log(file).records) == len(log.records)


def test_a_last_line_of_brackets_is_left_out(tmp_path):
    """Nested deeper than Python reads: it counts as cut off."""
    file = tmp_path / "log"
    log = execute(DRIVE, "forward()\n", IdealRobot(JACKAL), log=file)
    with file.open("a") as end:
        end.write("[" * 100_000)
    assert read_log(file).records == log.records


class Failing(IdealRobot):
    """An ideal robot that fails in one method, once it has moved a little."""

    def __init__(self, where, error):
        super().__init__(JACKAL)
        self.where, self.error, self.closed = where, error, False

    def _fail(self, where):
        if where == self.where and (len(self.commands) >= 3 or where in ("connect", "start")):
            raise self.error

    def connect(self):
        self._fail("connect")

    def start(self):
        self._fail("start")

    def read(self, sensor):
        self._fail("read")
        return super().read(sensor)

    def act(self, command):
        self._fail("act")
        super().act(command)

    def wait(self):
        self._fail("wait")
        return super().wait()

    def measured(self):
        self._fail("measured")
        return super().measured()

    def close(self):
        self.closed = True


@pytest.mark.parametrize("where", ["connect", "start", "read", "act", "wait", "measured"])
@pytest.mark.parametrize(
    ("error", "outcome"),
    [(RobotError("the link is lost"), "aborted"), (KeyboardInterrupt(), "stopped")],
)
def test_whatever_goes_wrong_stops_and_closes_the_robot(where, error, outcome):
    robot = Failing(where, error)
    log = execute(DRIVE, "while True:\n    forward()\n", robot)
    assert log.ending.outcome == outcome
    assert len(robot.stopped) == 1 and robot.stopped[0] and robot.closed


def test_a_bug_in_an_adapter_stops_the_robot_and_is_not_hidden(tmp_path):
    robot = Failing("act", ZeroDivisionError("bug"))
    with pytest.raises(ZeroDivisionError):
        execute(DRIVE, "while True:\n    forward()\n", robot, log=tmp_path / "log")
    assert robot.stopped and robot.closed
    assert "ZeroDivisionError" in read_log(tmp_path / "log").ending.reason


@pytest.mark.parametrize("where", ["stop", "health"])
def test_a_robot_that_fails_at_its_end_is_closed(where, tmp_path):
    robot = Failing("", None)

    def fail(*_):
        raise ZeroDivisionError("bug")

    setattr(robot, where, fail)
    with pytest.raises(ZeroDivisionError):
        execute(DRIVE, "forward()\n", robot, log=tmp_path / "log")
    assert robot.closed
    assert read_log(tmp_path / "log").ending.outcome == "finished"


@pytest.mark.parametrize("value", [float("nan"), float("-inf"), None, "fast", 10**400])
def test_a_measurement_that_is_no_number_aborts_the_run(value, tmp_path):
    class Odd(IdealRobot):
        def measured(self):
            return {"speed": value if len(self.commands) > 2 else 0.0}

    robot = Odd(JACKAL)
    log = execute(DRIVE, "while True:\n    forward()\n", robot, log=tmp_path / "log")
    assert log.ending.outcome == "aborted" and "speed is measured as" in log.ending.reason
    assert robot.stopped and read_log(tmp_path / "log") == log


@pytest.mark.parametrize("value", [1, 1.0, numpy.True_])
def test_a_reading_is_the_platforms_own_value(value):
    source = "while not people_observed():\n    forward()\n"
    log = execute(DRIVE, source, IdealRobot(JACKAL, lambda *_: value))
    assert log.ending.outcome == "finished" and len(log.records) == 1
    assert log.records[0].sensors["yolo_listener('people')"] is True


def test_a_reading_of_another_kind_aborts_the_run():
    robot = IdealRobot(JACKAL, lambda *_: numpy.array([True, False]))
    log = execute(DRIVE, DRIVE.plan_template, robot)
    assert log.ending.outcome == "aborted" and "reads array" in log.ending.reason


def test_a_log_that_cannot_be_written(tmp_path, monkeypatch):
    robot = Failing("", None)
    with pytest.raises(VasoError, match="the log cannot be written"):
        execute(DRIVE, "forward()\n", robot, log=tmp_path)
    assert not robot.stopped
    file, write = tmp_path / "log", Writer._write
    full = OSError(errno.ENOSPC, "No space left on device")

    def fill(writer, line):
        if len(writer.records) > 2:
            writer._file = SimpleNamespace(
                write=lambda _: (_ for _ in ()).throw(full), close=lambda: None
            )
        write(writer, line)

    monkeypatch.setattr(Writer, "_write", fill)
    log = execute(DRIVE, "while True:\n    forward()\n", robot, log=file)
    assert log.ending.outcome == "aborted" and "No space left" in log.ending.reason
    assert robot.stopped and robot.closed


def test_a_stale_sensor_is_not_a_false_one():
    robot = Failing("read", StaleReadingError("no detection for 1.2 s"))
    log = execute(DRIVE, DRIVE.plan_template, robot)
    assert log.ending.outcome == "aborted" and "no detection" in log.ending.reason


def test_a_bad_plan_never_touches_the_robot():
    robot = Failing("connect", AssertionError("touched"))
    with pytest.raises(PlanError):
        execute(DRIVE, "forwards()\n", robot)
    assert not robot.stopped


def test_a_bad_command_in_mid_run_stops_the_robot():
    robot = IdealRobot(JACKAL)
    log = execute(DRIVE, "forward()\nvelocity_publisher('fast')\n", robot)
    assert log.ending.outcome == "aborted" and "must be a number" in log.ending.reason
    assert len(robot.commands) == 1 and robot.stopped


def test_an_uncaught_exception_ends_the_plan_and_says_so():
    log = execute(DRIVE, "forward()\nx = 1 / 0\nforward()\n", IdealRobot(JACKAL))
    assert log.ending.outcome == "finished" and "ZeroDivisionError" in log.ending.reason
    assert "stays in force" not in log.ending.reason  # the robot is stopped
    assert len(log.records) == 2


def test_a_plan_that_computes_for_ever_is_cut():
    log = execute(DRIVE, "forward()\nwhile True:\n    x = 1\n", IdealRobot(JACKAL))
    assert log.ending.outcome == "aborted" and "longer than allowed" in log.ending.reason


class Fence:
    """Allows only so many forward commands, then stops."""

    def __init__(self, allowed):
        self.allowed, self.seen = allowed, []

    def observe(self, labels, measured):
        self.seen.append(labels)

    def judge(self, command, api):
        self.allowed -= api == "forward()"
        if api != "forward()" or self.allowed >= 0:
            return SimpleNamespace(command=command, intervention=None)
        why = Intervention(wanted=str(command), rule="G !forward", reason="that is far enough")
        return SimpleNamespace(command=JACKAL.rest, intervention=why)


def test_an_intervention_replaces_the_command_and_tells_the_plan():
    fence = Fence(2)
    source = (
        "try:\n    while True:\n        forward()\n"
        "except RuntimeError as error:\n    assert 'far enough' in str(error)\n    turn_left()\n"
    )
    log = execute(DRIVE, source, IdealRobot(JACKAL), shield=fence)
    assert log.ending.outcome == "finished" and log.ending.reason == ""
    assert [r.api for r in log.records[1:]] == ["forward()"] * 3 + ["turn_left()"]
    replaced = log.records[3]
    assert replaced.intervention.rule == "G !forward" and replaced.labels["stop"]
    assert fence.seen[3]["stop"] and not fence.seen[3]["forward"]


def test_a_plan_that_does_not_catch_it_ends_at_rest():
    robot = IdealRobot(JACKAL)
    log = execute(DRIVE, "while True:\n    forward()\n", robot, shield=Fence(1))
    assert "RuntimeError" in log.ending.reason and robot.commands[-1] == JACKAL.rest


def test_an_intervention_in_a_sleep_ends_the_sleep():
    robot = IdealRobot(JACKAL)

    class Later(Fence):
        def judge(self, command, api):
            if len(robot.commands) < 3:
                return SimpleNamespace(command=command, intervention=None)
            why = Intervention(wanted=str(command), rule="r", reason="someone is there")
            return SimpleNamespace(command=JACKAL.rest, intervention=why)

    source = "forward()\ntry:\n    time.sleep(60)\nexcept RuntimeError:\n    pass\n"
    log = execute(DRIVE, source, robot, shield=Later(0))
    assert len(log.records) == 5 and log.ending.outcome == "finished"
