"""A PX4 vehicle as its MAVLink messages show it, and the messages that command it.

Message and command names, numbers and masks are those of MAVLink's common dialect; the mode numbers
are PX4's (``px4_custom_mode.h``).
"""

from __future__ import annotations

import os
import socket
import time
from collections import deque
from dataclasses import dataclass
from typing import Any, NamedTuple

os.environ["MAVLINK20"] = "1"
os.environ["MAVLINK_DIALECT"] = "common"

from pymavlink import mavutil  # which reads its dialect from there

from vaso.modules.robots.px4_log import FlightLog

__all__ = ["LAND", "OFFBOARD", "M", "Mode", "Motion", "Vehicle"]

M = mavutil.mavlink
MULTICOPTERS = {
    M.MAV_TYPE_QUADROTOR,
    M.MAV_TYPE_HEXAROTOR,
    M.MAV_TYPE_OCTOROTOR,
    M.MAV_TYPE_TRICOPTER,
    M.MAV_TYPE_DODECAROTOR,
    M.MAV_TYPE_DECAROTOR,
    M.MAV_TYPE_COAXIAL,
}
VELOCITY_ONLY = 0x0DC7  # SET_POSITION_TARGET_LOCAL_NED.type_mask: what to ignore
POSITION_ONLY = 0x0DF8
SOURCE_SYSTEM = 245  # a ground station's, other than QGroundControl's 255
SOURCE_COMPONENT = M.MAV_COMP_ID_MISSIONPLANNER
ARM_SEEN_S = 1.2  # after which a heartbeat shows that the vehicle has armed
LOGGED = {
    "HEARTBEAT",
    "LOCAL_POSITION_NED",
    "EXTENDED_SYS_STATE",
    "COMMAND_ACK",
    "STATUSTEXT",
    "SYS_STATUS",
}


class Mode(NamedTuple):
    """A PX4 flight mode: main and sub mode."""

    main: int
    sub: int = 0

    def __str__(self) -> str:
        """Its name as PX4 writes it."""
        if self.main == 4:
            return f"AUTO.{AUTO.get(self.sub, str(self.sub))}"
        return MAIN.get(self.main, f"mode {self.main}")


MAIN = {1: "MANUAL", 2: "ALTCTL", 3: "POSCTL", 5: "ACRO", 6: "OFFBOARD", 7: "STABILIZED"}
AUTO = {1: "READY", 2: "TAKEOFF", 3: "LOITER", 4: "MISSION", 5: "RTL", 6: "LAND", 9: "PRECLAND"}
OFFBOARD = Mode(6)
LAND = Mode(4, 6)


@dataclass(frozen=True)
class Motion:
    """A LOCAL_POSITION_NED message.

    Attributes:
        time: The vehicle's clock in seconds (``time_boot_ms``).
        position: North, east, down in metres, in the vehicle's own frame.
        velocity: North, east, down in m/s.
        received: When it came, on this machine's monotonic clock.
    """

    time: float
    position: tuple[float, float, float]
    velocity: tuple[float, float, float]
    received: float


class Vehicle:
    """The connection to a vehicle and what is known of it.

    Args:
        url: As in :class:`~vaso.modules.robots.px4_settings.PX4Settings`.
        log: Where messages go.
        system: Take only the vehicle with this system id.

    Attributes:
        armed: What the last heartbeat says.
        mode: Flight mode in the last heartbeat.
        heard: When the last heartbeat came, on the monotonic clock; None before the first.
        motion: Last position and velocity.
        landed: Whether the vehicle says that it is on the ground; None if it does not say.
        restarted: Whether its clock has gone back.
        texts: Its last status texts, newest last.
        stranger: Another autopilot or kind of vehicle that was heard, in words.

    Raises:
        OSError: The link cannot be opened.
    """

    def __init__(self, url: str, log: FlightLog, system: int | None = None) -> None:
        self.armed = False
        self.mode = Mode(0)
        self.heard: float | None = None
        self.motion: Motion | None = None
        self.landed: bool | None = None
        self.restarted = False
        self.texts: deque[str] = deque(maxlen=20)
        self.stranger = ""
        self.acks: dict[int, int] = {}
        self._arm_asked: float | None = None
        self._system = system
        self._chunks: dict[int, str] = {}
        self._log = log
        self._link = _open(url)
        self._mav = self._link.mav
        self._target = (0, 0)

    def fileno(self) -> int | None:
        """The link's descriptor, if it has one that can be waited for."""
        return getattr(self._link, "fd", None)

    def receive(self) -> None:
        """Take all messages that have come."""
        for _ in range(1000):
            message = self._link.recv_msg()
            if message is None:
                return
            kind = message.get_type()
            if kind != "BAD_DATA" and self._is_ours(kind, message):
                if kind in LOGGED:
                    self._log.write(kind, message.to_dict())
                self._take(kind, message)

    def _is_ours(self, kind: str, message: Any) -> bool:
        """Whether it is from the autopilot; the first fitting heartbeat decides which that is."""
        source = (message.get_srcSystem(), message.get_srcComponent())
        if self._target != (0, 0):
            return source == self._target
        if kind != "HEARTBEAT" or self._system not in (None, source[0]):
            return False
        if message.autopilot == M.MAV_AUTOPILOT_INVALID or message.type == M.MAV_TYPE_GCS:
            return False
        if message.autopilot != M.MAV_AUTOPILOT_PX4:
            self.stranger = f"an autopilot that is not PX4 ({_name('MAV_AUTOPILOT', message)})"
        elif message.type not in MULTICOPTERS:
            self.stranger = f"a PX4 vehicle that is no multicopter ({_name('MAV_TYPE', message)})"
        else:
            self._target = source
            return True
        return False

    def _take(self, kind: str, message: Any) -> None:
        if kind == "HEARTBEAT":
            self.heard = time.monotonic()
            self.armed = bool(message.base_mode & M.MAV_MODE_FLAG_SAFETY_ARMED)
            self.mode = Mode((message.custom_mode >> 16) & 0xFF, message.custom_mode >> 24)
        elif kind == "LOCAL_POSITION_NED":
            self._move(message)
        elif kind == "EXTENDED_SYS_STATE":
            state = message.landed_state
            known = state != M.MAV_LANDED_STATE_UNDEFINED
            self.landed = state == M.MAV_LANDED_STATE_ON_GROUND if known else None
        elif kind == "COMMAND_ACK" and message.target_system in (0, SOURCE_SYSTEM):
            if message.result != M.MAV_RESULT_IN_PROGRESS:
                self.acks[message.command] = message.result
        elif kind == "STATUSTEXT":
            self._hear(message)

    def _move(self, message: Any) -> None:
        now = Motion(
            message.time_boot_ms / 1000,
            (message.x, message.y, message.z),
            (message.vx, message.vy, message.vz),
            time.monotonic(),
        )
        if self.motion is not None and now.time <= self.motion.time:
            if now.time >= self.motion.time - 1.0:
                return  # late or twice, or its clock stands: nothing is known by it
            self.restarted = True
        self.motion = now

    def _hear(self, message: Any) -> None:
        """A status text; long ones come in chunks of 50 characters."""
        text = message.text
        if message.id:
            text = self._chunks.pop(message.id, "") + text
            if len(message.text) == 50:
                self._chunks[message.id] = text
                return
        self.texts.append(text.strip())

    @property
    def found(self) -> bool:
        """Whether a vehicle has been heard."""
        return self.heard is not None

    @property
    def may_be_armed(self) -> bool:
        """Whether it is armed, or may have just been: heartbeats come once a second."""
        asked, answer = self._arm_asked, self.acks.get(M.MAV_CMD_COMPONENT_ARM_DISARM)
        if self.armed or asked is None or answer not in (None, M.MAV_RESULT_ACCEPTED):
            return self.armed
        return self.heard is not None and self.heard < asked + ARM_SEEN_S

    def say_alive(self) -> None:
        """A ground station's heartbeat, without which PX4 may refuse to arm."""
        self._send("heartbeat", M.MAV_TYPE_GCS, M.MAV_AUTOPILOT_INVALID, 0, 0, 4)

    def ask_for(self, message_id: int, hz: float) -> None:
        """Ask for a message at a rate."""
        self.command(M.MAV_CMD_SET_MESSAGE_INTERVAL, message_id, 1e6 / hz)

    def set_mode(self, mode: Mode) -> None:
        """Ask for a flight mode. The heartbeat says whether it was taken, not the answer."""
        flag = M.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        self.command(M.MAV_CMD_DO_SET_MODE, flag, mode.main, mode.sub)

    def arm(self, on: bool = True) -> None:
        """Ask to arm or disarm; never with the force flag."""
        self._arm_asked = time.monotonic() if on else None
        self.command(M.MAV_CMD_COMPONENT_ARM_DISARM, float(on))

    def command(self, number: int, *params: float) -> None:
        """Send a COMMAND_LONG; its answer will be in ``acks``."""
        self.acks.pop(number, None)
        self._send("command_long", *self._target, number, 0, *params, *[0.0] * (7 - len(params)))
        name = M.enums["MAV_CMD"][number].name
        self._log.write("COMMAND_LONG", {"sent": True, "command": name, "params": list(params)})

    def set_velocity(self, velocity: tuple[float, float, float]) -> None:
        """Send a velocity set-point in m/s."""
        self._set_target(VELOCITY_ONLY, (0.0, 0.0, 0.0), velocity)

    def set_position(self, position: tuple[float, float, float]) -> None:
        """Send a position set-point in metres, in the vehicle's own frame."""
        self._set_target(POSITION_ONLY, position, (0.0, 0.0, 0.0))

    def _set_target(
        self,
        mask: int,
        position: tuple[float, float, float],
        velocity: tuple[float, float, float],
    ) -> None:
        clock = int(self.motion.time * 1000) & 0xFFFFFFFF if self.motion else 0
        frame = M.MAV_FRAME_LOCAL_NED
        rest = (0.0, 0.0, 0.0, 0.0, 0.0)  # acceleration, yaw, yaw rate: ignored
        numbers = (*position, *velocity, *rest)
        self._send("set_position_target_local_ned", clock, *self._target, frame, mask, *numbers)
        fields = dict(zip(("x", "y", "z", "vx", "vy", "vz"), numbers, strict=False))
        sent = {"sent": True, "time_boot_ms": clock, "type_mask": mask, **fields}
        self._log.write("SET_POSITION_TARGET_LOCAL_NED", sent)

    def _send(self, message: str, *fields: float) -> None:
        getattr(self._mav, f"{message}_send")(*fields)


def _name(enum: str, message: Any) -> str:
    number = message.autopilot if enum == "MAV_AUTOPILOT" else message.type
    entry = M.enums[enum].get(number)
    return entry.name if entry is not None else str(number)


def _open(url: str) -> Any:
    """Open a link. A UDP port that another program listens on is not shared with it."""
    kind, _, rest = url.partition(":")
    rest = rest.removeprefix("//")
    if kind in ("udp", "udpin"):
        host, _, port = rest.rpartition(":")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind((host, int(port)))
    device, baud = (f"{kind}:{rest}", 57600)
    if kind.startswith("/"):
        device, baud = kind, int(rest or 57600)
    elif kind not in ("udp", "udpin", "udpout", "tcp"):
        raise ValueError("it begins with udp:, udpin:, udpout:, tcp: or a serial device's path")
    return mavutil.mavlink_connection(
        device,
        baud=baud,
        source_system=SOURCE_SYSTEM,
        source_component=SOURCE_COMPONENT,
        dialect="common",
    )
