"""In motion, one thing fails: the vehicle is in a safe state soon, and on the ground in the end.

All in real time, because the bound is one of real time; it is measured at the vehicle.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("pymavlink", reason="needs the extra px4")

sys.path.insert(0, str(Path(__file__).parent))

from px4_testing import HERE, MACHINE_S, SAFE_WITHIN_S, Vehicle

LAND = [4, 6]
BOUND = SAFE_WITHIN_S + MACHINE_S
DOWN = 30.0
slow = pytest.mark.slow


class Flying:
    """A plan process, its driver and the vehicle, moving east at 1 m."""

    def __init__(self, folder: Path, *options: str) -> None:
        self.folder = folder
        self.options = options
        self.driver = 0
        self.begin()

    def begin(self) -> None:
        """Start the processes; nothing is waited for."""
        self.vehicle = Vehicle(self.folder, ready_s=0.3, ramps=False, land_disarm_s=0.5)
        script = [sys.executable, str(HERE / "px4_plan.py"), self.vehicle.url]
        log = str(self.folder / "flight.jsonl")
        self.plan = subprocess.Popen(
            [*script, log, *self.options], stdout=subprocess.PIPE, text=True
        )

    def wait(self) -> Flying:
        """Until it moves. A machine that is too slow for a flight is given other chances."""
        for _ in range(3):
            assert self.plan.stdout is not None
            word, *rest = self.plan.stdout.readline().split() or [""]
            if word == "moving":
                self.driver = int(rest[0])
                return self
            said = (word, rest, self.plan.stdout.read(), self.vehicle.summary())
            self.close()
            self.begin()
        raise AssertionError(said)

    def said(self) -> str:
        """What the plan process has said until its end."""
        return self.plan.communicate(timeout=DOWN)[0]

    def close(self) -> None:
        self.plan.kill()
        self.plan.communicate()
        if self.driver:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.driver, signal.SIGKILL)
        self.vehicle.close()


@pytest.fixture
def flying(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Flying]:
    started = Flying(tmp_path, *getattr(request, "param", ()))
    yield started.wait()
    started.close()


@pytest.fixture(scope="module")
def fleet(tmp_path_factory: pytest.TempPathFactory) -> Iterator[list[Flying]]:
    """Three that take off at the same time, because that takes longest."""
    started = [Flying(tmp_path_factory.mktemp("fleet")) for _ in range(3)]
    yield [one.wait() for one in started]
    for one in started:
        one.close()


def lands(vehicle: Vehicle, since: float) -> None:
    """It was told to land within the bound, landed, and disarmed itself."""
    told = vehicle.wait_for("mode", since, mode=LAND)
    assert told["m"] - since < BOUND, vehicle.summary()
    rests(vehicle, since)


def rests(vehicle: Vehicle, since: float) -> None:
    """In the end it is on the ground and off, and nobody has taken it back before."""
    off = vehicle.wait_for("disarmed", since, DOWN)
    assert off["why"] == "by itself"
    assert not vehicle.report("reentered"), vehicle.summary()


def goes_silent(vehicle: Vehicle, since: float) -> None:
    """The last set-point came within the bound."""
    last = max(r["m"] for r in vehicle.report("setpoint"))
    assert last - since < BOUND, vehicle.summary()


def test_the_plan_process_is_killed(fleet: list[Flying]) -> None:
    flying = fleet[0]
    now = time.monotonic()
    flying.plan.kill()
    lands(flying.vehicle, now)


def test_the_driver_is_killed(fleet: list[Flying]) -> None:
    flying = fleet[1]
    now = time.monotonic()
    os.kill(flying.driver, signal.SIGKILL)
    failsafe = flying.vehicle.wait_for("failsafe", now)
    assert failsafe["m"] - now < BOUND
    assert "ended: the px4 driver has ended (signal 9)" in flying.said()
    rests(flying.vehicle, now)


def test_the_link_is_cut(fleet: list[Flying]) -> None:
    """The vehicle's failsafe acts; when the link comes back, nobody takes the vehicle back."""
    flying = fleet[2]
    now = flying.vehicle.fault(cut=True)
    failsafe = flying.vehicle.wait_for("failsafe", now)
    assert failsafe["m"] - now < BOUND
    assert flying.plan.stdout is not None
    assert "ended: no position from the vehicle" in flying.plan.stdout.readline()
    os.kill(flying.driver, 0)  # it is there, and tries to land
    flying.vehicle.fault(cut=False)
    rests(flying.vehicle, now)


@slow
def test_the_pilot_takes_over(flying: Flying) -> None:
    now = flying.vehicle.fault(mode=[3, 0])
    assert "ended: the vehicle has left offboard mode for POSCTL" in flying.said()
    goes_silent(flying.vehicle, now)
    time.sleep(0.5)
    assert not [r for r in flying.vehicle.report("mode") if r["m"] > now and r["mode"] != [3, 0]]
    assert not flying.vehicle.report("reentered")


@slow
@pytest.mark.parametrize(
    ("silent", "limit", "why"),
    [("LOCAL_POSITION_NED", 0.0, "no position"), ("HEARTBEAT", 2.5, "no heartbeat")],
)
def test_the_vehicle_stops_telling(flying: Flying, silent: str, limit: float, why: str) -> None:
    """It stands still within the bound. Two heartbeats may be lost before it is landed."""
    now = flying.vehicle.fault(mute=[silent])
    told = flying.vehicle.wait_for("mode", now, mode=LAND)
    assert told["m"] - now < limit + BOUND
    moving = [r["m"] for r in flying.vehicle.report("setpoint") if any(r["numbers"])]
    assert max(moving) - now < BOUND
    assert f"ended: {why} from the vehicle" in flying.said()
    rests(flying.vehicle, now)


@slow
def test_the_vehicles_clock_stands(flying: Flying) -> None:
    """Time is the vehicle's own: without it a command would be in force for ever."""
    now = flying.vehicle.fault(stick=True)
    lands(flying.vehicle, now)
    assert "ended: no position from the vehicle" in flying.said()


@slow
def test_the_vehicles_own_failsafe(flying: Flying) -> None:
    """A mode change that nobody here has asked for ends the stream, whoever made it."""
    now = flying.vehicle.fault(mode=[4, 5])
    assert "AUTO.RTL" in flying.said()
    goes_silent(flying.vehicle, now)
    rests(flying.vehicle, now)


@slow
def test_the_plan_process_hangs(flying: Flying) -> None:
    now = time.monotonic()
    flying.plan.send_signal(signal.SIGSTOP)
    lands(flying.vehicle, now)


@slow
@pytest.mark.parametrize("flying", [("stall",)], indirect=True)
def test_the_plan_gives_no_command(flying: Flying) -> None:
    """The vehicle hovers at once, at the end of the path, and lands when that has lasted 1 s."""
    now = time.monotonic()
    held = flying.vehicle.wait_for("setpoint", now, kind="position")
    assert held["m"] - now < BOUND
    told = flying.vehicle.wait_for("mode", now, mode=LAND)
    assert told["m"] - now < 1.0 + BOUND
    rests(flying.vehicle, now)


@slow
@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGINT])
def test_the_driver_is_told_to_end(flying: Flying, how: signal.Signals) -> None:
    now = time.monotonic()
    os.kill(flying.driver, how)
    lands(flying.vehicle, now)
    assert "ended: the driver was told to end" in flying.said()


@slow
def test_ctrl_c(flying: Flying) -> None:
    now = time.monotonic()
    flying.plan.send_signal(signal.SIGINT)
    lands(flying.vehicle, now)
    said = flying.said()
    assert "interrupted" in said and "'phase': 'landed'" in said


@slow
def test_sigterm_to_the_plan_process(flying: Flying) -> None:
    now = time.monotonic()
    flying.plan.terminate()
    lands(flying.vehicle, now)


@slow
@pytest.mark.parametrize("seconds", [1.2, 3.0])
def test_the_driver_is_held_up(flying: Flying, seconds: float) -> None:
    """A driver that comes back after PX4's failsafe has begun does not stream on."""
    now = time.monotonic()
    os.kill(flying.driver, signal.SIGSTOP)
    time.sleep(seconds)
    os.kill(flying.driver, signal.SIGCONT)
    rests(flying.vehicle, now)


@slow
def test_the_vehicle_leaves_the_fence(flying: Flying) -> None:
    now = flying.vehicle.fault(shift=[40.0, 0.0, 0.0])
    lands(flying.vehicle, now)
    assert "outside the fence" in flying.said()
