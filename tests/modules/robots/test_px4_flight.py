"""Whole flights of the PX4 adapter against the test vehicle, faster than real time."""

from __future__ import annotations

import json
import math
import socket
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pymavlink", reason="needs the extra px4")

sys.path.insert(0, str(Path(__file__).parent))

from px4_testing import UNHURRIED, Vehicle, fly, robot, square

from vaso.errors import MissingDependencyError, RobotError
from vaso.execution import Robot
from vaso.modules.robots import PX4Mavlink

SPEED = 5.0
slow = pytest.mark.slow


class Stand:
    """Makes vehicles and robots for a test, and ends them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.vehicle: Vehicle | None = None
        self.robots: list[PX4Mavlink] = []
        self.told: list[str] = []

    def __call__(self, settings: dict[str, Any] | None = None, **config: Any) -> PX4Mavlink:
        self.vehicle = Vehicle(self.folder, **{"speed": SPEED, **config})
        given = {"connect_s": 10.0, "ready_s": 20.0, **UNHURRIED, **(settings or {})}
        px4 = robot(self.vehicle, self.folder, on_event=self.told.append, **given)
        self.robots.append(px4)
        return px4

    def close(self) -> None:
        for px4 in self.robots:
            px4.close()
        if self.vehicle is not None:
            self.vehicle.close()


@pytest.fixture
def stand(tmp_path: Path) -> Iterator[Stand]:
    made = Stand(tmp_path)
    yield made
    made.close()


def test_it_is_a_robot() -> None:
    assert isinstance(PX4Mavlink(), Robot)


def test_a_small_square(stand: Stand) -> None:
    """Up, around, down; then everything that is known of the flight."""
    px4 = stand()
    px4.connect()
    px4.start()
    periods, states = fly(px4, square(1.0, 1.0))
    px4.stop()
    assert px4.health().ok and px4.health().details["armed"] is False
    px4.close()
    corners = [states[i] for i in (3, 6, 9, 12, 15)]  # each at the end of a pause
    for corner, (x, y) in zip(corners, [(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)], strict=True):
        assert math.dist((corner["x"], corner["y"]), (x, y)) < 0.4
        assert corner["altitude"] == pytest.approx(1.0, abs=0.4)
    assert states[0]["altitude"] == 0 and states[-1]["altitude"] == 0
    assert all(s["linear_velocity"] == 0 for s in states if s["altitude"] == 0)
    assert all(s["linear_velocity"] <= 1 for s in states)
    assert [s["velocity_change"] for s in states[:5]] == [0, 0.5, 0, 0.5, 0.5], "of the commands"
    times = [0.0] + [p.time for p in periods]
    assert all(later > sooner for sooner, later in pairwise(times))
    assert periods[0].overrun > 1.0, "the take-off ramp"
    assert stand.vehicle is not None
    assert stand.vehicle.report("disarmed")[0]["why"] == "by itself"
    check_flight_log(px4.flight_log)


def check_flight_log(path: Path) -> None:
    """The shape that docs/robots/px4.md describes."""
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    assert all(isinstance(r["t"], float) and isinstance(r["type"], str) for r in lines)
    assert [r["t"] for r in lines] == sorted(r["t"] for r in lines)
    kinds = {r["type"] for r in lines}
    assert {"HEARTBEAT", "LOCAL_POSITION_NED", "COMMAND_ACK", "COMMAND_LONG", "VASO"} <= kinds
    sent = [r for r in lines if r["type"] == "SET_POSITION_TARGET_LOCAL_NED"]
    assert all(r["sent"] is True for r in sent)
    place = next(r for r in lines if r["type"] == "LOCAL_POSITION_NED")
    assert {"time_boot_ms", "x", "y", "z", "vx", "vy", "vz"} <= set(place)
    assert "sent" not in place


@slow
def test_two_take_offs_in_one_plan(stand: Stand) -> None:
    px4 = stand(ramps=False, land_disarm_s=0.5)
    px4.connect()
    px4.start()
    _, states = fly(px4, [(0, 0, -1), (0, 0, 1), (0, 0, 0), (0, 0, -1), (0, 0, 1)])
    altitudes = [round(s["altitude"]) for s in states]
    assert altitudes == [0, 1, 0, 0, 1, 0]


@slow
def test_a_vehicle_that_never_gets_ready(stand: Stand) -> None:
    px4 = stand({"ready_s": 4.0}, refuses=True)
    px4.connect()
    with pytest.raises(
        RobotError,
        match=r"refuses to arm .Arming denied: Compass 0 not calibrated, see the sensors page",
    ):
        px4.start()
    assert any("arming is refused" in text for text in stand.told)
    px4.stop()
    assert px4.health().details["armed"] is False


@slow
def test_a_vehicle_without_a_position(stand: Stand) -> None:
    px4 = stand({"ready_s": 2.5}, ready_s=1e6)
    px4.connect()
    with pytest.raises(RobotError, match="no local position"):
        px4.start()
    assert any("position estimate" in text for text in stand.told)


@slow
@pytest.mark.parametrize(
    ("config", "why"),
    [({"kind": 1}, "no multicopter .MAV_TYPE_FIXED_WING"), ({"autopilot": 3}, "not PX4")],
)
def test_another_kind_of_vehicle(stand: Stand, config: dict[str, int], why: str) -> None:
    with pytest.raises(RobotError, match=why):
        stand(**config).connect()


def test_nobody_is_there(tmp_path: Path) -> None:
    px4 = PX4Mavlink("udp:127.0.0.1:0", flight_log=tmp_path / "f.jsonl", connect_s=0.3)
    with pytest.raises(RobotError, match="no vehicle has been heard"):
        px4.connect()
    px4.stop()
    px4.close()


def test_the_port_is_taken(tmp_path: Path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        taken.bind(("127.0.0.1", 0))
        url = f"udp:127.0.0.1:{taken.getsockname()[1]}"
        px4 = PX4Mavlink(url, flight_log=tmp_path / "f.jsonl")
        with pytest.raises(RobotError, match=r"cannot be opened.*[Aa]ddress already in use"):
            px4.connect()
        px4.close()


@pytest.mark.parametrize("url", ["", "nonsense", "udp:here", "udp:127.0.0.1:port", "/dev/no:1"])
def test_an_address_that_makes_no_sense(tmp_path: Path, url: str) -> None:
    px4 = PX4Mavlink(url, flight_log=tmp_path / "f.jsonl", connect_s=0.3)
    with pytest.raises(RobotError, match="cannot be opened"):
        px4.connect()
    assert not px4.health().ok
    px4.close()


@pytest.mark.parametrize(
    "settings",
    [{"fence_radius": math.nan}, {"rate_hz": 2}, {"max_altitude": -1}, {"colour": "red"}],
)
def test_a_setting_that_makes_no_sense(settings: dict[str, Any]) -> None:
    with pytest.raises(RobotError, match=next(iter(settings))):
        PX4Mavlink(**settings)


@slow
@pytest.mark.parametrize(
    ("last", "why"),
    [
        ((0.0, math.nan, 0.0), "finite numbers"),
        ((0.0, 2.5, 0.0), "faster than the limit"),
        ((0.0, 0.0, -2.0), "above the altitude limit"),
        ((0.0, 2.0, 0.0), "outside the fence"),
    ],
)
def test_a_command_beyond_the_limits_lands(
    stand: Stand, last: tuple[float, float, float], why: str
) -> None:
    px4 = stand(
        {"max_altitude": 2.5, "fence_radius": 1.5}, ramps=False, land_disarm_s=0.5, ready_s=1.0
    )
    px4.connect()
    px4.start()
    with pytest.raises(RobotError, match=why):
        fly(px4, [(0, 0, -1), last])
    px4.stop()
    assert not px4.health().ok and px4.health().details["phase"] == "landed"


@slow
def test_a_vehicle_that_does_not_lift(stand: Stand) -> None:
    px4 = stand({"climb_s": 4.0}, lifts=False)
    px4.connect()
    px4.start()
    with pytest.raises(RobotError, match="has not climbed within 4 s"):
        fly(px4, [(0, 0, -1)])
    px4.stop()
    assert px4.health().details["armed"] is False


@slow
def test_an_error_in_the_driver_lands(stand: Stand) -> None:
    """Whatever it is: here, a request without its fields."""
    px4 = stand(ramps=False, land_disarm_s=0.5, ready_s=1.0)
    px4.connect()
    px4.start()
    fly(px4, [(0, 0, -1), (0, 0.5, 0)])
    px4._link.send("act")
    assert stand.vehicle is not None
    stand.vehicle.wait_for("disarmed", why="by itself")
    with pytest.raises(RobotError, match="the driver has failed"):
        fly(px4, [(0, 0.5, 0)])


def test_calls_in_the_wrong_order(tmp_path: Path) -> None:
    px4 = PX4Mavlink(flight_log=tmp_path / "f.jsonl")
    with pytest.raises(RobotError, match="not connected"):
        px4.start()
    with pytest.raises(RobotError, match="not connected"):
        px4.act(px4.platform.rest)
    with pytest.raises(RobotError, match="no command to wait for"):
        px4.wait()
    with pytest.raises(RobotError, match="no sensor"):
        px4.read("camera()")
    px4.stop()
    px4.close()


def test_without_pymavlink(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(MissingDependencyError, match="pymavlink"):
        PX4Mavlink(flight_log=tmp_path / "f.jsonl").connect()
