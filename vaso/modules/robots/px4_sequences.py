"""What is done in a fixed order: find the vehicle, arm it, land it.

Each sequence is a generator that the driver resumes once a tick; it ends by returning, or by
raising :class:`SequenceError`. The order and the times are those that PX4 needs: set-points are
streamed before offboard mode is asked for, and the mode before arming.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

from vaso.modules.robots.px4_mavlink import LAND, OFFBOARD, M, Vehicle
from vaso.modules.robots.px4_settings import PX4Settings

__all__ = ["UNHEARD_S", "SequenceError", "arming", "finding", "landing"]

Sequence = Iterator[None]
STRANGERS_S = 2.0  # others may be heard first
STREAM_FIRST_S = 1.2  # of set-points, before offboard mode is asked for
MODE_AGAIN_S = 1.5
ARM_AGAIN_S = 2.0
LAND_AGAIN_S = 0.5
DISARM_AFTER_S = 40.0  # of landing, for vehicles that are set not to disarm themselves
UNHEARD_S = 5.0  # without a heartbeat on the ground
LANDED_STATE_HZ = 5.0


class SequenceError(Exception):
    """The vehicle does not do what is needed.

    Args:
        text: What is wrong, in words.
        hint: What the user can do.
    """

    def __init__(self, text: str, hint: str = "") -> None:
        super().__init__(text)
        self.text = text
        self.hint = hint


def finding(vehicle: Vehicle, settings: PX4Settings) -> Sequence:
    """Wait for the heartbeat of a PX4 multicopter, and ask for its position."""
    began = time.monotonic()
    limit = began + settings.connect_s
    while not vehicle.found:
        if vehicle.stranger and time.monotonic() > began + STRANGERS_S:
            raise SequenceError(
                f"{settings.url}: there is {vehicle.stranger}",
                "the adapter flies PX4 multicopters only",
            )
        if time.monotonic() > limit:
            raise SequenceError(
                f"{settings.url}: no vehicle has been heard for {settings.connect_s:g} s",
                "start PX4 first; docs/robots/px4.md has the commands and the ports",
            )
        yield
    for message, hz in (
        (M.MAVLINK_MSG_ID_LOCAL_POSITION_NED, settings.rate_hz),
        (M.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, LANDED_STATE_HZ),
    ):
        vehicle.ask_for(message, hz)
        yield


def arming(
    vehicle: Vehicle,
    settings: PX4Settings,
    stream: Callable[[], None],
    tell: Callable[[str], None],
) -> Sequence:
    """Wait for a position, stream zero set-points, enter offboard mode, and arm.

    Args:
        vehicle: The vehicle, on the ground.
        settings: ``ready_s`` bounds it all.
        stream: Called when the stream of zero set-points is to begin.
        tell: Called with what is being waited for.
    """
    limit = time.monotonic() + settings.ready_s
    if vehicle.armed:
        raise SequenceError(
            "the vehicle is armed already",
            "VASO begins with a disarmed vehicle on the ground; land it first",
        )
    while vehicle.landed is False:  # so says a land detector that has just begun
        _check(vehicle, limit, "it says that it is in the air")
        yield
    yield from _position(vehicle, settings, limit, tell)
    stream()
    yield from _pause(STREAM_FIRST_S)
    yield from _offboard(vehicle, limit, tell)
    yield from _armed(vehicle, limit, tell)


def _position(
    vehicle: Vehicle, settings: PX4Settings, limit: float, tell: Callable[[str], None]
) -> Sequence:
    asked = time.monotonic()
    told = False
    while vehicle.motion is None or time.monotonic() - vehicle.motion.received > 0.5:
        now = time.monotonic()
        if now - asked > 2.0:
            if not told:
                tell("waiting for the vehicle's position estimate")
                told = True
            vehicle.ask_for(M.MAVLINK_MSG_ID_LOCAL_POSITION_NED, settings.rate_hz)
            asked = now
        _check(vehicle, limit, "it sends no local position: its estimator is not ready")
        yield


def _offboard(vehicle: Vehicle, limit: float, tell: Callable[[str], None]) -> Sequence:
    """The heartbeat decides: PX4 accepts the mode even where it will not arm in it."""
    asked = 0.0
    while vehicle.mode != OFFBOARD:
        now = time.monotonic()
        if now - asked > MODE_AGAIN_S:
            vehicle.set_mode(OFFBOARD)
            asked = now
        _check(vehicle, limit, f"it stays in {vehicle.mode} instead of OFFBOARD")
        yield


def _armed(vehicle: Vehicle, limit: float, tell: Callable[[str], None]) -> Sequence:
    """Until its estimator and sensors are ready, which takes up to a minute, PX4 refuses."""
    command = M.MAV_CMD_COMPONENT_ARM_DISARM
    asked, refusals = 0.0, 0
    while not vehicle.armed:
        now = time.monotonic()
        result = vehicle.acks.get(command)
        if asked and result not in (None, M.MAV_RESULT_ACCEPTED):
            vehicle.acks.pop(command)
            refusals += 1
            if refusals == 1:
                tell(f"arming is refused for now{_told(vehicle)}; trying again")
        if now - asked > ARM_AGAIN_S:
            vehicle.arm()
            asked = now
        if vehicle.mode != OFFBOARD:
            raise SequenceError(f"it has left OFFBOARD for {vehicle.mode} before it was armed")
        _check(vehicle, limit, f"it refuses to arm{_told(vehicle)}")
        yield


def landing(vehicle: Vehicle, settings: PX4Settings, taken_off: Callable[[], bool]) -> Sequence:
    """Ask for AUTO.LAND until the vehicle is in it, and wait until it has disarmed itself.

    It is asked only while the vehicle was last known to be in offboard mode: another mode is that
    of a pilot or of its own failsafe, and is left alone.
    """
    began = time.monotonic()
    limit, asked = began + settings.land_s, 0.0
    while vehicle.may_be_armed:
        now = time.monotonic()
        if now - asked > LAND_AGAIN_S:
            if vehicle.mode == OFFBOARD:
                vehicle.set_mode(LAND)
            elif vehicle.landed and (not taken_off() or now - began > DISARM_AFTER_S):
                vehicle.arm(False)  # it has not flown, or does not do it; refused in the air
            asked = now
        if now > limit:
            raise SequenceError(f"the vehicle has not disarmed within {settings.land_s:g} s")
        yield


def _pause(seconds: float) -> Sequence:
    limit = time.monotonic() + seconds
    while time.monotonic() < limit:
        yield


def _check(vehicle: Vehicle, limit: float, complaint: str) -> None:
    now = time.monotonic()
    if vehicle.heard is None or now - vehicle.heard > UNHEARD_S:
        raise SequenceError("the vehicle is not heard any more")
    if now > limit:
        raise SequenceError(
            f"the vehicle does not get ready: {complaint}", "look at it in QGroundControl"
        )


def _told(vehicle: Vehicle) -> str:
    """What the vehicle has said last, for a message."""
    return f" ({'; '.join(list(vehicle.texts)[-3:])})" if vehicle.texts else ""
