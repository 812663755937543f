"""What the tests of the PX4 adapter share: a vehicle, a robot, a plan flown period by period."""

from __future__ import annotations

import json
import math
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from vaso.execution import Period
from vaso.modules.robots import PX4Mavlink
from vaso.platforms import Issued

HERE = Path(__file__).parent
SAFE_WITHIN_S = 1.5  # the requirement, measured at the vehicle
MACHINE_S = 0.5  # what a loaded test machine may add
PATIENCE = 30.0
Vector = tuple[float, float, float]
UNHURRIED = {
    "position_lost_s": 5.0,
    "heartbeat_lost_s": 5.0,
    "silence_s": 5.0,
    "stall_s": 5.0,
    "held_up_s": 5.0,
}
"""For tests faster than real time, which are not about failures: the machine may be busy."""


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Vehicle:
    """The test vehicle's process."""

    def __init__(self, folder: Path, **config: Any) -> None:
        self.port = free_port()
        self.url = f"udp:127.0.0.1:{self.port}"
        self.speed = config.get("speed", 1.0)
        self._report = folder / "vehicle.jsonl"
        script = [sys.executable, HERE / "px4_vehicle.py", str(self.port), self._report]
        self._process = subprocess.Popen(
            [*script, json.dumps(config)], stdin=subprocess.PIPE, text=True
        )

    def fault(self, **fault: Any) -> float:
        """Play a fault; returns when, on the vehicle's record."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(fault) + "\n")
        self._process.stdin.flush()
        return float(self.wait_for("fault", fault=fault)["m"])

    def report(self, event: str | None = None, **fields: Any) -> list[dict[str, Any]]:
        """What it has recorded: lines of one event, with these fields."""
        lines = self._report.read_text().split("\n")[:-1] if self._report.exists() else []
        read = (json.loads(line) for line in lines)
        wanted = {**fields} if event is None else {"event": event, **fields}
        return [r for r in read if all(r.get(k) == v for k, v in wanted.items())]

    def wait_for(
        self, event: str, after: float = 0.0, patience: float = PATIENCE, **fields: Any
    ) -> dict[str, Any]:
        limit = time.monotonic() + patience
        while time.monotonic() < limit:
            for line in self.report(event, **fields):
                if line["m"] >= after:
                    return line
            time.sleep(0.02)
        raise AssertionError(f"the vehicle has not recorded {event} {fields}: {self.summary()}")

    def summary(self) -> list[str]:
        return [
            f"{r['t']:.1f} {r['event']} {r.get('mode') or r.get('why') or r.get('problem') or ''}"
            for r in self.report()
            if r["event"] not in ("setpoint", "truth")
        ]

    def close(self) -> None:
        self._process.kill()
        self._process.wait()
        assert self._process.stdin is not None
        self._process.stdin.close()


def robot(vehicle: Vehicle, folder: Path, **settings: Any) -> PX4Mavlink:
    given = {"rate_hz": 20.0 * min(vehicle.speed, 5.0), **settings}
    return PX4Mavlink(vehicle.url, flight_log=folder / "flight.jsonl", **given)


def fly(
    px4: PX4Mavlink, velocities: Iterable[Vector], each: Callable[[int], None] = lambda _: None
) -> tuple[list[Period], list[dict[str, float]]]:
    """Fly velocities, one a period; returns the periods, and what was measured in each state."""
    periods, states = [], [dict(px4.measured())]
    for step, velocity in enumerate(velocities):
        each(step)
        px4.act(Issued(name="set_velocity", arguments=(("velocity", tuple(velocity)),)))
        periods.append(px4.wait())
        states.append(dict(px4.measured()))
    return periods, states


def square(side: float, altitude: float, speed: float = 0.5) -> list[Vector]:
    """Take off, a square with pauses, land."""
    along, up = math.ceil(side / speed), math.ceil(altitude / speed)
    v, w = side / along, altitude / up
    legs: list[Vector] = [(v, 0, 0), (0, v, 0), (-v, 0, 0), (0, -v, 0)]
    plan: list[Vector] = [(0, 0, -w)] * up + [(0, 0, 0)]
    for leg in legs:
        plan += [leg] * along + [(0, 0, 0)]
    return [*plan, *[(0.0, 0.0, w)] * up, (0, 0, 0)]
