"""The driver's logic, with a base that only remembers: when the velocity is zero, and why."""

import json
import math
import socket
import threading
import time

import pytest

from vaso.errors import RobotError
from vaso.modules.robots.jackal_detections import Detections
from vaso.modules.robots.jackal_guard import SILENCE_S, Guard
from vaso.modules.robots.jackal_messages import Report, read_report
from vaso.modules.robots.jackal_node import JackalDriver
from vaso.modules.robots.jackal_settings import JackalSettings
from vaso.modules.robots.jackal_watchdog import Refused, Watchdog
from vaso.modules.robots.link import Channel

PEOPLE = read_report('[{"class": "person", "score": 0.9}]')


def test_the_watchdog_passes_a_velocity_on_while_the_plan_lives():
    dog = Watchdog(timeout=0.5)
    dog.start(0.0)
    assert dog.velocity(0.4) == (0.0, 0.0)
    dog.command(0.3, -0.1, 0.4)
    assert dog.velocity(0.8) == (0.3, -0.1)
    dog.alive(0.8)
    assert dog.velocity(1.2) == (0.3, -0.1)
    assert dog.velocity(1.4) == (0.0, 0.0)
    assert "no sign of life for 0.60 s" in dog.reason


def test_a_driver_that_was_held_up_does_not_move_on():
    """What has queued up meanwhile is read before the next tick."""
    dog = Watchdog(timeout=0.5)
    dog.start(0.0)
    dog.command(0.3, 0.0, 0.0)
    with pytest.raises(Refused, match="no sign of life"):
        dog.command(0.3, 0.0, 1.0, sent=0.9)
    dog.start(2.0)
    dog.command(0.3, 0.0, 2.0)
    dog.alive(3.0)
    assert dog.velocity(3.0) == (0.0, 0.0)
    dog.start(4.0)
    with pytest.raises(Refused, match=r"0\.70 s late"):
        dog.command(0.3, 0.0, 5.0, sent=4.3)
    assert dog.velocity(5.0) == (0.0, 0.0)


def test_the_watchdog_stays_stopped_until_a_new_start():
    dog = Watchdog()
    dog.start(0.0)
    dog.trip("a reason")
    dog.trip("another one")
    dog.alive(0.1)
    with pytest.raises(Refused, match=r"^a reason$"):
        dog.command(0.3, 0.0, 0.1)
    assert dog.velocity(0.1) == (0.0, 0.0)
    dog.start(1.0)
    dog.command(0.3, 0.0, 1.0)
    assert dog.velocity(1.0) == (0.3, 0.0)
    dog.stop()
    assert dog.velocity(1.0) == (0.0, 0.0)
    with pytest.raises(Refused, match="no run"):
        dog.command(0.3, 0.0, 1.1)


@pytest.mark.parametrize(
    ("linear", "angular"), [(2.1, 0), (-2.1, 0), (0, 4.1), (math.nan, 0), (0, math.inf)]
)
def test_the_watchdog_refuses_what_is_out_of_bounds(linear, angular):
    dog = Watchdog()
    dog.start(0.0)
    dog.command(0.3, 0.0, 0.0)
    with pytest.raises(Refused, match="the limit is"):
        dog.command(linear, angular, 0.1)
    assert dog.velocity(0.1) == (0.0, 0.0)


class Base:
    """A base that remembers what it was told."""

    def __init__(self):
        self.problem, self.listeners, self.rivals, self.emergency = "", 1, 0, False
        self.told = []

    def publish(self, linear, angular):
        self.told.append((linear, angular))

    def odometry(self, now):
        return {}, math.inf

    def other_types(self):
        return ["geometry_msgs/msg/Twist"]


class Watcher:
    """A guard that remembers what it was told, and may be dead."""

    def __init__(self):
        self.told, self.problem = [], ""
        self.state = {"listeners": 1}

    def send(self, kind):
        self.told.append(kind)

    def check(self):
        if self.problem:
            raise RobotError(self.problem)


class Rig:
    """A driver and VASO's end of its link."""

    def __init__(self, **settings):
        ours, theirs = socket.socketpair()
        self.vaso, self.base, self.detections = Channel(ours), Base(), Detections()
        self.guard = Watcher()
        self.driver = JackalDriver(
            Channel(theirs),
            self.base,
            self.detections,
            JackalSettings(**settings).for_driver(),
            threading.Lock(),
            self.guard,
        )
        self.see(Report())

    def see(self, report, age=0.0):
        self.detections.add("/detections", report, time.monotonic() - age)

    def ask(self, kind, **fields):
        self.driver.handle({"kind": kind, "id": 1, **fields})
        return next(m for m in reversed(self.vaso.receive(1.0)) if m["kind"] == "answer")

    def tick(self):
        self.driver.tick(time.monotonic())
        return [m for m in self.vaso.receive(1.0) if m["kind"] == "state"][-1]


@pytest.fixture
def rig():
    return Rig()


def test_nothing_is_published_before_the_start(rig):
    assert rig.tick()["running"] is False
    assert "error" in rig.ask("command", linear=0.3, angular=0.0)
    assert rig.base.told == []
    assert "tick" not in rig.guard.told


def test_a_command_goes_out_at_once_and_at_every_tick(rig):
    rig.ask("start")
    assert rig.base.told == [(0.0, 0.0)]
    assert "error" not in rig.ask("command", linear=0.3, angular=0.1)
    state = rig.tick()
    assert rig.base.told[-2:] == [(0.3, 0.1)] * 2
    assert state["velocity"] == [0.3, 0.1]
    assert rig.guard.told[-1] == "tick"


def test_a_reading(rig):
    rig.see(PEOPLE)
    assert rig.ask("read", name="people")["value"] is True
    assert rig.ask("read", name="chair")["value"] is False
    rig.see(PEOPLE, age=0.6)
    answer = rig.ask("read", name="people")
    assert (answer["name"], "value" in answer) == ("StaleReadingError", False)


def test_at_rest_silence_is_no_reason_to_give_up(rig):
    """An agent thinks for seconds between two commands."""
    rig.ask("start")
    rig.ask("command", linear=0.0, angular=0.0)
    rig.see(Report(), age=9)
    rig.driver.tick(time.monotonic() + 60)
    rig.see(Report())
    assert "error" not in rig.ask("command", linear=0.3, angular=0.0)


def test_nothing_moves_off_while_a_detector_is_silent(rig):
    rig.ask("start")
    rig.see(Report(), age=9)
    assert rig.ask("command", linear=0.0, angular=0.1)["name"] == "StaleReadingError"
    assert set(rig.base.told) == {(0.0, 0.0)}


def trouble(rig, what):
    match what:
        case "stale":
            rig.see(Report(), age=0.6)
        case "deaf":
            rig.base.listeners = 0
        case "emergency":
            rig.base.emergency = True
        case "unguarded":
            rig.guard.problem = "the guard has ended"
        case "ros":
            rig.base.problem = "the ROS node does not run any more"


@pytest.mark.parametrize(
    ("what", "reason"),
    [
        ("stale", "the last report on /detections is 0.60 s old"),
        ("deaf", "nothing listens to /j100_0000/cmd_vel any more"),
        ("emergency", "the emergency stop is pressed"),
        ("unguarded", "the guard has ended"),
        ("ros", "the ROS node does not run any more"),
    ],
)
def test_trouble_stops_the_base_for_good(rig, what, reason):
    rig.ask("start")
    rig.ask("command", linear=0.3, angular=0.0)
    trouble(rig, what)
    state = rig.tick()
    assert state["reason"].startswith(reason)
    assert state["stale"] is (what == "stale")
    assert rig.base.told[-1] == (0.0, 0.0)
    rig.see(Report())
    rig.base.listeners, rig.base.emergency, rig.base.problem = 1, False, ""
    rig.guard.problem = ""
    refused = rig.ask("command", linear=0.3, angular=0.0)
    assert refused["error"].startswith(reason)
    assert refused["name"] == ("StaleReadingError" if what == "stale" else "RobotError")
    assert rig.base.told[-1] == (0.0, 0.0)
    rig.ask("start")
    assert "error" not in rig.ask("command", linear=0.3, angular=0.0)


def test_without_a_detector_none_is_waited_for():
    rig = Rig(detections="")
    rig.see(Report(), age=9)
    rig.ask("start")
    assert "error" not in rig.ask("command", linear=0.3, angular=0.0)


def test_a_stop_is_answered_after_zero_went_out(rig):
    rig.ask("start")
    rig.ask("command", linear=0.3, angular=0.0)
    rig.ask("stop")
    assert rig.base.told[-1] == (0.0, 0.0)
    assert rig.tick()["running"] is False
    assert rig.base.told[-1] == (0.0, 0.0)


@pytest.mark.parametrize("how", ["killed", "stalled"])
def test_the_driver_ends_at_rest_when_vaso_goes(rig, how):
    rig.ask("start")
    rig.ask("command", linear=0.3, angular=0.0)
    rig.see(Report(), age=-60)  # the detector goes on
    thread = threading.Thread(target=rig.driver.run)
    thread.start()
    if how == "killed":
        rig.vaso.close()
    else:
        while rig.base.told[-1] != (0.0, 0.0):
            time.sleep(0.01)
        assert "no sign of life" in rig.driver.watchdog.reason
        rig.vaso.close()
    thread.join(10)
    assert not thread.is_alive()
    assert rig.base.told[-5:] == [(0.0, 0.0)] * 5
    assert rig.guard.told[-1] == "idle"


def test_every_message_can_travel_as_json(rig):
    rig.ask("start")
    json.dumps(rig.driver.state(time.monotonic()), allow_nan=False)


@pytest.fixture
def guard():
    ours, theirs = socket.socketpair()
    return Channel(ours), Guard(Channel(theirs), Base())


def test_the_guard_is_silent_while_the_driver_speaks(guard):
    driver, watching = guard
    watching.handle({"kind": "tick"})
    watching.watch(watching.heard + SILENCE_S / 2)
    watching.handle({"kind": "idle"})
    watching.watch(watching.heard + 10)
    driver.close()
    watching.run()
    assert watching.publisher.told == []


def test_the_guard_stops_a_base_whose_driver_hangs(guard):
    _, watching = guard
    watching.handle({"kind": "tick"})
    watching.watch(watching.heard + SILENCE_S * 1.1)
    assert watching.publisher.told == [(0.0, 0.0)]


def test_the_guard_stops_a_base_whose_driver_died(guard):
    driver, watching = guard
    driver.send("tick")
    driver.close()
    watching.run()
    assert len(watching.publisher.told) > 3
    assert set(watching.publisher.told) == {(0.0, 0.0)}


def test_a_base_that_the_guard_does_not_reach_is_not_there_yet(rig):
    assert rig.driver.state(time.monotonic())["listeners"] == 1
    rig.guard.state = {}
    assert rig.driver.state(time.monotonic())["listeners"] == 0


class LateBase(Base):
    """A base that is found a little later."""

    def __init__(self):
        self.found = time.monotonic() + 1.3
        super().__init__()

    @property
    def listeners(self):
        return int(time.monotonic() > self.found)

    @listeners.setter
    def listeners(self, value):
        pass


def test_the_guard_goes_on_until_somebody_has_listened():
    ours, theirs = socket.socketpair()
    driver, watching = Channel(ours), Guard(Channel(theirs), LateBase())
    watching.handle({"kind": "tick"})
    driver.close()
    watching.run()
    assert time.monotonic() - watching.publisher.found > 0.9
