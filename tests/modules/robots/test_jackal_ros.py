"""A Jackal over real ROS 2: velocities and failures as a second ROS process hears them."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from vaso import load_skill
from vaso.cli import run
from vaso.errors import RobotError, StaleReadingError
from vaso.execution import Robot, execute
from vaso.modules.robots import JackalROS
from vaso.modules.robots.tools import RobotTools

sys.path.insert(0, str(Path(__file__).parent))

from ros_testing import EMPTY, HERE, PATIENCE_S, PATIENT, PERSON, Peer, private_ros, ros_python

PEOPLE = "yolo_listener('people')"


@pytest.fixture(scope="module", autouse=True)
def python(tmp_path_factory):
    """The Python of ROS, with topics that nobody else hears."""
    with pytest.MonkeyPatch.context() as patch:
        for name, value in private_ros(tmp_path_factory.mktemp("ros")).items():
            patch.setenv(name, value)
        yield ros_python()


@pytest.fixture(scope="module")
def running_peer(python):
    peer = Peer(python)
    yield peer
    peer.close()


@pytest.fixture(scope="module")
def connected(running_peer, python):
    robot = JackalROS(python=python, **PATIENT)
    robot.connect()
    yield robot
    robot.close()


@pytest.fixture
def peer(running_peer):
    running_peer.tell(detections=EMPTY, emergency=False, odometry=False)
    return running_peer


@pytest.fixture
def robot(connected, peer):
    """A robot at rest, in a run."""
    limit = time.monotonic() + PATIENCE_S
    while time.monotonic() < limit:
        with contextlib.suppress(RobotError):
            connected.read(PEOPLE)
            connected.start()
            break
    yield connected
    connected.stop()


def drive(robot, linear=0.3, angular=0.0, periods=3):
    command = robot.platform.command("velocity_publisher").issue((linear, angular), {})
    for _ in range(periods):
        robot.act(command)
        period = robot.wait()
    return period


def drive_until_refused(robot):
    with pytest.raises(RobotError) as caught:
        drive(robot, periods=int(PATIENCE_S / robot.platform.dt))
    return caught.value


def test_velocities_go_out_at_10_hz_or_more(robot, peer):
    begin = time.monotonic()
    period = drive(robot, 0.3, -0.2, periods=10)
    end = time.monotonic()  # it goes on until it is stopped
    heard = [h for h in peer.heard if begin < h[0] < end and h[1:] == (0.3, -0.2)]
    assert len(heard) >= 10
    assert period.time >= 10 * robot.platform.dt
    assert robot.measured() == {"speed": 0.3, "turn_rate": -0.2}
    robot.stop()
    peer.assert_stopped(end)


def test_late_periods_are_reported(robot):
    drive(robot, periods=1)
    time.sleep(0.25)
    period = drive(robot, periods=1)
    assert period.overrun >= 0.24
    assert period.seconds >= 0.34  # the late command was in force for a whole period
    assert drive(robot, periods=1).seconds >= 0.09  # the next one is whole again


def test_it_is_a_robot(robot):
    assert isinstance(robot, Robot)
    assert robot.health().ok
    assert robot.health().details["listeners"] == 1
    assert robot.health().details["other publishers of velocities"] == 0


def test_an_agent_may_think_for_long(robot, peer):
    agent = RobotTools(robot)
    move = next(t for t in agent.tools if t.name == "velocity_publisher")
    for _ in range(2):
        time.sleep(1.2)
        assert move(linear=0.2, angular=0.0, seconds=0.3).startswith("done")
        peer.until(lambda: not peer.moves(), "it goes on moving")


def test_readings(robot, peer):
    assert robot.read(PEOPLE) is False
    peer.tell(detections=PERSON)
    peer.until(lambda: robot.read(PEOPLE), "people are not observed")
    assert robot.read("yolo_listener('chair')") is False
    peer.tell(detections='[{"class": "person", "score": 0.3}]')
    peer.until(lambda: not robot.read(PEOPLE), "a doubtful detection counts")


def test_odometry_is_measured(robot, peer):
    peer.tell(odometry=True)
    drive(robot, 0.3, 0.1, periods=5)
    peer.until(lambda: drive(robot, 0.3, 0.1) and "x" in robot.measured(), "no odometry")
    assert robot.measured()["speed"] == pytest.approx(0.3)
    robot.stop()
    assert robot.measured()["speed"] < 0.05
    peer.tell(odometry=False)
    peer.until(lambda: robot.health().details["age of odometry (s)"] > 1.0, "it goes on")
    with pytest.raises(StaleReadingError, match="platform/odom/filtered"):
        robot.measured()


def test_silent_detectors_stop_the_base(robot, peer):
    drive(robot)
    fault = peer.tell(detections=None)
    error = drive_until_refused(robot)
    assert isinstance(error, StaleReadingError)
    assert "the last report on /j100_0000/detections is" in error.message
    peer.assert_stopped(fault)
    with pytest.raises(StaleReadingError):
        robot.read(PEOPLE)


def test_detections_that_cannot_be_read_stop_the_base(robot, peer):
    drive(robot)
    fault = peer.tell(detections="people: none")
    assert "cannot be read: no JSON" in drive_until_refused(robot).message
    peer.assert_stopped(fault)


def test_the_emergency_stop(robot, peer):
    drive(robot)
    fault = peer.tell(emergency=True)
    assert drive_until_refused(robot).message == "the emergency stop is pressed"
    peer.assert_stopped(fault)
    with pytest.raises(RobotError, match="emergency stop"):
        robot.start()


def test_a_plan_that_thinks_for_too_long_stops_the_base(robot, peer):
    drive(robot)
    fault = time.monotonic()
    time.sleep(1.3)
    assert "no sign of life" in drive_until_refused(robot).message
    peer.assert_stopped(fault)


def test_a_velocity_out_of_bounds_stops_the_base(robot, peer):
    drive(robot)
    fault = time.monotonic()
    with pytest.raises(RobotError, match=r"9 m/s is asked for; the limit is 2"):
        drive(robot, linear=9.0)
    peer.assert_stopped(fault)


def test_a_verified_plan_drives_and_stops_for_people(peer, python):
    """The whole way: sandbox, labelling code, adapter, topics."""
    said = []

    def watch(record):
        said.append(record.api)
        if record.step == 8:
            peer.tell(detections=PERSON)

    robot = JackalROS(python=python, **PATIENT)
    plan = "while True:\n    if people_observed():\n        stop()\n    else:\n        forward()\n"
    log = execute(load_skill("drive"), plan, robot, seconds=2.0, on_record=watch)
    assert log.ending.outcome == "stopped", log.ending
    assert said[1:8] == ["forward()"] * 7
    assert said[-3:] == ["stop()"] * 3
    assert not any(r.sensors[PEOPLE] for r in log.records[:8])
    assert log.records[-1].sensors[PEOPLE] is True


@pytest.fixture
def fresh(peer, python):
    """A robot with a driver of its own, to be broken."""
    robot = JackalROS(python=python, **PATIENT)
    robot.connect()
    robot.start()
    drive(robot)
    peer.until(peer.moves, "it does not move")
    yield robot
    robot.stop()
    robot.close()


@pytest.mark.parametrize(
    "number",
    [
        signal.SIGKILL,
        pytest.param(signal.SIGTERM, marks=pytest.mark.slow),
        pytest.param(signal.SIGSTOP, marks=pytest.mark.slow),
    ],
)
def test_a_driver_that_dies_or_hangs(fresh, peer, number):
    fault = time.monotonic()
    os.kill(fresh.driver_pid, number)
    peer.assert_stopped(fault)
    message = drive_until_refused(fresh).message
    assert "the jackal driver has ended" in message or "silent" in message
    if number == signal.SIGSTOP:
        os.kill(fresh.driver_pid, signal.SIGCONT)
        time.sleep(0.5)
        assert not peer.moves()


@pytest.mark.slow
def test_the_guard_dies(fresh, peer):
    pid = fresh.driver_pid
    guard = int(Path(f"/proc/{pid}/task/{pid}/children").read_text().split()[0])
    fault = time.monotonic()
    os.kill(guard, signal.SIGKILL)
    peer.assert_stopped(fault)
    assert "the guard has ended" in drive_until_refused(fresh).message


def test_the_link_is_lost(fresh, peer):
    fault = time.monotonic()
    fresh._driver._channel._socket.shutdown(2)
    peer.assert_stopped(fault)
    assert "the jackal driver has ended" in drive_until_refused(fresh).message


@pytest.mark.parametrize(
    "number", [signal.SIGKILL, pytest.param(signal.SIGSTOP, marks=pytest.mark.slow)]
)
def test_a_plan_process_that_dies_or_stalls(peer, python, number):
    command = [sys.executable, str(HERE / "jackal_plan.py"), python, json.dumps(PATIENT)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        peer.until(peer.moves, "it does not move")
        fault = time.monotonic()
        process.send_signal(number)
        peer.assert_stopped(fault)
        if number == signal.SIGSTOP:
            process.send_signal(signal.SIGCONT)
            ending = json.loads(process.communicate(timeout=PATIENCE_S)[0])
            assert ending["outcome"] == "aborted"
            assert "no sign of life" in ending["reason"] or "silent" in ending["reason"]
            assert not peer.moves()
    finally:
        process.kill()
        process.wait()


@pytest.mark.slow
def test_a_base_that_does_not_listen_any_more(python):
    peer = Peer(python, topic="/other/cmd_vel")
    robot = JackalROS("/other/cmd_vel", python=python, detections="", **PATIENT)
    robot.connect()
    robot.start()
    drive(robot)
    peer.close()
    assert "nothing listens to /other/cmd_vel any more" in drive_until_refused(robot).message
    robot.close()


@pytest.mark.slow
def test_twist_without_a_stamp(python):
    peer = Peer(python, topic="/cmd_vel", stamped=False)
    with pytest.raises(RobotError, match=r"takes geometry_msgs/msg/Twist, not TwistStamped"):
        JackalROS("/cmd_vel", python=python, patience=8).connect()
    robot = JackalROS("/cmd_vel?stamped=false", python=python, **PATIENT)
    robot.connect()
    robot.start()
    drive(robot)
    peer.until(peer.moves, "it does not move")
    robot.close()
    peer.until(lambda: not peer.moves(), "it goes on moving")
    peer.close()


@pytest.mark.slow
def test_the_clock_of_a_simulator(python):
    peer = Peer(python, topic="/sim/cmd_vel", clock=100)
    url = "/sim/cmd_vel?use_sim_time=true"
    robot = JackalROS(url, python=python, **PATIENT)
    robot.connect()
    robot.start()
    drive(robot)
    peer.until(lambda: peer.stamps[-1:] == [100], "velocities have another time")
    robot.close()
    peer.close()


@pytest.mark.slow
def test_vaso_robot_check(peer, python, monkeypatch, capfd):
    monkeypatch.setenv("VASO_ROS_PYTHON", python)
    before = len(peer.heard)
    assert run(["robot", "check", "jackal", "--connect", "?patience=30", "--json"]) == 0
    told = json.loads(capfd.readouterr().out)
    assert told["ok"] and told["details"]["listeners"] == 1
    assert len(peer.heard) == before


@pytest.mark.slow
def test_nobody_is_there(python):
    with pytest.raises(RobotError) as caught:
        JackalROS("/nobody/cmd_vel", python=python, patience=1).connect()
    assert "nothing subscribes to its velocity topic" in caught.value.message
    assert "no detections have come on /nobody/detections" in caught.value.message
