"""A PX4-like quadcopter as a process that speaks MAVLink over UDP, for the tests of the adapter.

    python px4_vehicle.py PORT REPORT '{"speed": 1.0, ...}'

It is a peer, not a copy of PX4: the parts of PX4's behaviour that an offboard controller meets
are there, with the constants of PX4's defaults. Lines of JSON on standard input play faults. The
report, JSON lines with this machine's monotonic time, says what it was sent and how it truly moved.
"""

from __future__ import annotations

import json
import math
import os
import random
import select
import sys
import time
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil

M = mavutil.mavlink
OFFBOARD, LAND, RTL, LOITER, POSCTL = (6, 0), (4, 6), (4, 5), (4, 3), (3, 0)
STEP = 0.01  # s of simulated time
AHEAD_S = 0.15  # of the last set-point; faster than real time the vehicle waits for the next one
OFFBOARD_LOSS_S = 1.0  # COM_OF_LOSS_T
LAND_SPEED = 0.7  # MPC_LAND_SPEED
IDLE_DISARM_S = 10.0  # COM_DISARM_PRFLT
SPOOL_UP_S, RAMP_S = 1.0, 3.0  # COM_SPOOLUP_TIME, MPC_TKO_RAMP_T
LAG_XY, LAG_Z = 0.56, 0.25  # MPC_XY_VEL_P_ACC, MPC_Z_VEL_P_ACC
MOST_ACCELERATION = 5.0
PULL = 0.95  # MPC_XY_P


@dataclass
class Config:
    """How the vehicle behaves; times in simulated seconds."""

    speed: float = 1.0  # simulated seconds per second; limits on a peer's silence are not scaled
    ready_s: float = 3.0  # until its estimator has a position and it can arm
    ground_z: float = 0.7  # down, in its own frame: PX4's origin need not be the ground
    home: tuple[float, float] = (1.5, -2.0)
    drag: float = 0.15  # 1/s
    wind: tuple[float, float] = (0.05, -0.03)  # m/s^2 that no controller takes out
    noise: float = 0.02
    drift: float = 0.05  # m, of the estimator, slowly
    refuses: bool = False
    kind: int = M.MAV_TYPE_QUADROTOR
    autopilot: int = M.MAV_AUTOPILOT_PX4
    ramps: bool = True
    lifts: bool = True
    land_disarm_s: float = 2.0  # COM_DISARM_LAND
    seed: int = 1


class Vehicle:
    def __init__(self, port: int, report: Path, config: Config) -> None:
        self.config = config
        self.random = random.Random(config.seed)
        self.link = mavutil.mavlink_connection(
            f"udpout:127.0.0.1:{port}", source_system=1, source_component=1, dialect="common"
        )
        self.report = report.open("w")
        self.time = 0.0
        self.position = [*config.home, config.ground_z]
        self.velocity = [0.0, 0.0, 0.0]
        self.error = [0.0, 0.0, 0.0]
        self.mode = LOITER
        self.intended = LOITER  # what was asked for; a failsafe does not change it
        self.armed = False
        self.armed_at = self.rose_at = 0.0
        self.flew = False
        self.touched_at: float | None = -1.0
        self.setpoint: tuple[str, list[float]] | None = None
        self.setpoint_at = -math.inf
        self.ground_station_at = -math.inf
        self.rates = {"LOCAL_POSITION_NED": 0.0, "EXTENDED_SYS_STATE": 0.0}
        self.due: dict[str, float] = {}
        self.muted: set[str] = set()
        self.cut = False
        self.stuck: int | None = None  # what its clock says from then on
        self.texts = 0

    # the world

    @property
    def landed(self) -> bool:
        return self.touched_at is not None and self.time - self.touched_at > 0.7

    def say(self, event: str, **more: Any) -> None:
        line = {"m": time.monotonic(), "t": round(self.time, 3), "event": event, **more}
        self.report.write(json.dumps(line) + "\n")
        self.report.flush()

    def run(self) -> None:
        last, goal = time.monotonic(), 0.0
        while True:
            self.control()
            self.receive()
            now = time.monotonic()
            goal += (now - last) * self.config.speed
            last = now
            if self.config.speed > 1 and self.armed and self.mode == OFFBOARD:
                goal = min(goal, self.setpoint_at + AHEAD_S)
            while self.time + STEP <= goal:
                self.time += STEP
                self.move()
                self.watch()
                self.send()
            time.sleep(0.004)

    def control(self) -> None:
        """Faults, from the test."""
        while select.select([sys.stdin], [], [], 0)[0]:
            line = sys.stdin.readline()
            if not line:
                raise SystemExit
            fault = json.loads(line)
            self.say("fault", fault=fault)
            self.muted |= set(fault.get("mute", []))
            self.cut = fault.get("cut", self.cut)
            if "stick" in fault:
                self.stuck = int(self.time * 1000)
            if "mode" in fault:
                self.intended = self.mode = (fault["mode"][0], fault["mode"][1])
                self.say("mode", mode=self.mode)
            if "shift" in fault:
                self.position = [a + b for a, b in zip(self.position, fault["shift"], strict=True)]

    def wanted(self) -> list[float]:
        """The velocity that the controller of the mode wants."""
        match self.mode:
            case (6, 0) if self.setpoint is not None:
                kind, numbers = self.setpoint
                if kind == "velocity":
                    return numbers
                pulls = [PULL * (s - m) for s, m in zip(numbers, self.seen(), strict=True)]
                return [max(-3.0, min(3.0, p)) for p in pulls]
            case (4, 6):
                return [0.0, 0.0, LAND_SPEED]
            case (4, 5):
                way = [h - p for h, p in zip(self.config.home, self.position, strict=False)]
                if math.hypot(*way) < 0.3:
                    return [0.0, 0.0, LAND_SPEED]
                return [max(-1.0, min(1.0, w)) for w in way] + [0.0]
        return [0.0, 0.0, 0.0]

    def seen(self) -> list[float]:
        return [p + e for p, e in zip(self.position, self.error, strict=True)]

    def move(self) -> None:
        for i in range(3):  # the estimator's slow error
            self.error[i] += -self.error[i] * STEP / 10
            self.error[i] += self.random.gauss(0, self.config.drift) * math.sqrt(2 * STEP / 10)
        if not self.armed:
            return
        wanted = self.wanted()
        if self.touched_at is not None and not self.rises(wanted):
            self.velocity = [0.0, 0.0, 0.0]
            return
        if self.config.ramps and wanted[2] < 0:
            share = (self.time - self.rose_at - SPOOL_UP_S) / RAMP_S
            wanted = [*wanted[:2], max(wanted[2], -1.5 * max(0.0, share))]
        self.follow(wanted)
        self.touch()

    def rises(self, wanted: list[float]) -> bool:
        """Whether a vehicle on the ground takes off."""
        if wanted[2] >= 0 or not self.config.lifts:
            self.rose_at = self.time
            return False
        return self.time - self.rose_at > SPOOL_UP_S or not self.config.ramps

    def follow(self, wanted: list[float]) -> None:
        for i, lag in enumerate((LAG_XY, LAG_XY, LAG_Z)):
            pull = max(-1.0, min(1.0, (wanted[i] - self.velocity[i]) / lag / MOST_ACCELERATION))
            wind = self.config.wind[i] if i < 2 else 0.0
            acceleration = pull * MOST_ACCELERATION - self.config.drag * self.velocity[i] + wind
            self.velocity[i] += acceleration * STEP
            self.position[i] += self.velocity[i] * STEP

    def touch(self) -> None:
        ground = self.config.ground_z
        if self.position[2] >= ground:
            self.position[2] = ground
            self.velocity = [0.0, 0.0, 0.0]
            self.touched_at = self.time if self.touched_at is None else self.touched_at
        elif self.position[2] < ground - 0.05:
            if self.touched_at is not None:
                self.say("lift")
            self.touched_at, self.flew = None, True

    def watch(self) -> None:
        """Failsafes and automatic disarming."""
        if not self.armed:
            return
        silent = self.time - self.setpoint_at > OFFBOARD_LOSS_S * self.config.speed
        if self.mode == OFFBOARD and silent:
            self.mode = RTL
            self.say("failsafe", mode=self.mode)
        if self.landed:
            down_for = self.time - (self.touched_at or 0.0)
            limit = self.config.land_disarm_s + 0.7 if self.flew else IDLE_DISARM_S
            if down_for > limit and self.time - self.armed_at > limit:
                self.disarm("by itself")

    def disarm(self, why: str) -> None:
        self.armed, self.flew = False, False
        self.say("disarmed", why=why)

    # the link

    def receive(self) -> None:
        while (message := self.link.recv_msg()) is not None:
            if not self.cut:
                self.take(message.get_type(), message)

    def take(self, kind: str, message: Any) -> None:
        if kind == "HEARTBEAT" and message.type == M.MAV_TYPE_GCS:
            self.ground_station_at = self.time
        elif kind == "SET_POSITION_TARGET_LOCAL_NED":
            self.target(message)
        elif kind == "COMMAND_LONG":
            self.command(message)

    def target(self, message: Any) -> None:
        assert message.coordinate_frame == M.MAV_FRAME_LOCAL_NED
        assert message.type_mask in (0x0DC7, 0x0DF8), hex(message.type_mask)
        assert (message.target_system, message.target_component) == (1, 1)
        if message.type_mask == 0x0DC7:
            self.setpoint = ("velocity", [message.vx, message.vy, message.vz])
        else:
            self.setpoint = ("position", [message.x, message.y, message.z])
        self.setpoint_at = self.time
        self.say("setpoint", kind=self.setpoint[0], numbers=self.setpoint[1])
        if self.armed and self.intended == OFFBOARD and self.mode != OFFBOARD:
            self.mode = OFFBOARD  # PX4 does so when the stream comes back during its failsafe
            self.say("reentered")

    def command(self, message: Any) -> None:
        number, result = message.command, M.MAV_RESULT_ACCEPTED
        if number == M.MAV_CMD_SET_MESSAGE_INTERVAL:
            names = {32: "LOCAL_POSITION_NED", 245: "EXTENDED_SYS_STATE"}
            self.rates[names[int(message.param1)]] = 1e6 / message.param2
        elif number == M.MAV_CMD_DO_SET_MODE:
            self.intended = self.mode = (int(message.param2), int(message.param3))
            self.say("mode", mode=self.mode)
        elif number == M.MAV_CMD_COMPONENT_ARM_DISARM:
            assert message.param2 == 0, "the force flag is set"
            result = self.arm(message.param1 == 1)
        else:
            result = M.MAV_RESULT_UNSUPPORTED
        source = (message.get_srcSystem(), message.get_srcComponent())
        self.link.mav.command_ack_send(number, result, 0, 0, *source)

    def arm(self, on: bool) -> int:
        if not on:
            if not self.landed:
                return M.MAV_RESULT_TEMPORARILY_REJECTED
            self.disarm("on request")
            return M.MAV_RESULT_ACCEPTED
        problem = self.problem()
        self.say("arming", problem=problem)
        if problem:
            self.tell(f"Arming denied: {problem}")
            return M.MAV_RESULT_TEMPORARILY_REJECTED
        self.armed, self.armed_at, self.touched_at = True, self.time, self.time - 1
        self.rose_at = self.time
        return M.MAV_RESULT_ACCEPTED

    def tell(self, text: str) -> None:
        """A status text; long ones go in chunks of 50 characters."""
        self.texts += len(text) > 50
        for start in range(0, len(text), 50):
            chunk = text[start : start + 50].encode()
            self.link.mav.statustext_send(
                2, chunk, self.texts if len(text) > 50 else 0, start // 50
            )

    def problem(self) -> str:
        if self.config.refuses:
            return "Compass 0 not calibrated, see the sensors page of the ground station"
        if self.time < self.config.ready_s + 1:
            return "ekf2 missing data"
        if self.time - self.ground_station_at > 3.0 * self.config.speed:
            return "No connection to the ground control station"
        if self.mode == OFFBOARD and self.time - self.setpoint_at > 0.5 * self.config.speed:
            return "No offboard signal"
        return ""

    def send(self) -> None:
        if self.is_due("HEARTBEAT", 1.0):
            self.heartbeats()
        ready = self.time >= self.config.ready_s
        if self.is_due("LOCAL_POSITION_NED", self.rates["LOCAL_POSITION_NED"]) and ready:
            noise = [self.random.gauss(0, self.config.noise) for _ in range(6)]
            place = [a + b for a, b in zip(self.seen(), noise, strict=False)]
            moves = [a + b for a, b in zip(self.velocity, noise[3:], strict=True)]
            clock = int(self.time * 1000) if self.stuck is None else self.stuck
            self.link.mav.local_position_ned_send(clock, *place, *moves)
        if self.is_due("EXTENDED_SYS_STATE", self.rates["EXTENDED_SYS_STATE"]):
            state = M.MAV_LANDED_STATE_ON_GROUND if self.landed else M.MAV_LANDED_STATE_IN_AIR
            self.link.mav.extended_sys_state_send(0, state)
        if self.is_due("truth", 10.0, aloud=False):
            self.say(
                "truth",
                place=[round(p, 4) for p in self.position],
                velocity=[round(v, 4) for v in self.velocity],
                armed=self.armed,
                mode=self.mode,
            )

    def heartbeats(self) -> None:
        """Its own, a camera's, and a ground station's that is routed through."""
        base = M.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | (self.armed and M.MAV_MODE_FLAG_SAFETY_ARMED)
        custom = self.mode[0] << 16 | self.mode[1] << 24
        state = M.MAV_STATE_ACTIVE if self.armed else M.MAV_STATE_STANDBY
        mav, camera = self.link.mav, M.MAV_COMP_ID_CAMERA
        for system, component, kind, pilot, flags, mode in (
            (1, camera, M.MAV_TYPE_CAMERA, M.MAV_AUTOPILOT_INVALID, 0, 0),
            (255, 190, M.MAV_TYPE_GCS, M.MAV_AUTOPILOT_INVALID, 0, 0),
            (1, 1, self.config.kind, self.config.autopilot, base, custom),
        ):
            mav.srcSystem, mav.srcComponent = system, component
            mav.heartbeat_send(kind, pilot, flags, mode, state)

    def is_due(self, what: str, hz: float, aloud: bool = True) -> bool:
        if hz <= 0 or self.time < self.due.get(what, 0.0):
            return False
        self.due[what] = max(self.due.get(what, 0.0) + 1 / hz, self.time)
        return not aloud or (what not in self.muted and not self.cut)


def main() -> None:
    given = json.loads(sys.argv[3]) if len(sys.argv) > 3 else {}
    known = {f.name for f in fields(Config)}
    assert set(given) <= known, set(given) - known
    Vehicle(int(sys.argv[1]), Path(sys.argv[2]), Config(**given)).run()


if __name__ == "__main__":
    main()
