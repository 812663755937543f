"""What must hold before a command goes to a PX4 vehicle, and at every moment of its flight."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

from vaso.modules.robots.px4_mavlink import OFFBOARD, Vehicle
from vaso.modules.robots.px4_path import NominalPath, Vector
from vaso.modules.robots.px4_settings import PX4Settings

__all__ = ["Fault", "command_fault", "flight_fault", "is_late"]


@dataclass(frozen=True)
class Fault:
    """Why a flight ends before its plan.

    Attributes:
        text: In words.
        is_ours: False if the vehicle obeys somebody else now, a pilot or its own failsafe. Nothing
            is sent to it any more then: a set-point would take it back.
        is_deaf: Whether the vehicle, or where it is, is no longer known. Set-points end at once.
    """

    text: str
    is_ours: bool = True
    is_deaf: bool = False


def command_fault(
    velocity: Sequence[float], period: float, settings: PX4Settings, path: NominalPath
) -> str | None:
    """Why a velocity is not flown; None if it may be."""
    numbers = [v for v in velocity if isinstance(v, int | float) and math.isfinite(v)]
    if len(velocity) != 3 or len(numbers) != 3:
        return f"a velocity is three finite numbers (north, east, down), not {velocity!r}"
    if (speed := math.hypot(*numbers)) > settings.speed_limit + 1e-9:
        return f"{speed:.2f} m/s is faster than the limit of {settings.speed_limit:g} m/s"
    end = path.end_of((numbers[0], numbers[1], numbers[2]), period)
    return _outside(end, settings, "the command leads")


def flight_fault(vehicle: Vehicle, settings: PX4Settings, place: Vector | None) -> Fault | None:
    """What is wrong with an armed vehicle now; None if nothing is.

    Args:
        vehicle: What is known of it.
        settings: The limits.
        place: Where it is, from the take-off point.
    """
    now = time.monotonic()
    if vehicle.heard is None or now - vehicle.heard > settings.heartbeat_lost_s:
        return Fault("no heartbeat from the vehicle", is_deaf=True)
    if vehicle.restarted:
        return Fault("the autopilot has restarted in flight", is_deaf=True)
    if not vehicle.armed:
        return Fault("the vehicle has disarmed in flight", is_ours=False)
    if vehicle.mode != OFFBOARD:
        return Fault(
            f"the vehicle has left offboard mode for {vehicle.mode}: a pilot or its own failsafe "
            "has taken over",
            is_ours=False,
        )
    age = now - vehicle.motion.received if vehicle.motion else math.inf
    if age > settings.position_lost_s or place is None:
        return Fault(f"no position from the vehicle for {age:.1f} s", is_deaf=True)
    if not all(map(math.isfinite, place)):
        return Fault("the vehicle's position is no number", is_deaf=True)
    outside = _outside(place, settings, "the vehicle is")
    return Fault(outside) if outside else None


def is_late(vehicle: Vehicle, settings: PX4Settings) -> bool:
    """Whether so little has been heard of a vehicle lately that it should stand still."""
    now = time.monotonic()
    ages = (
        (vehicle.heard, settings.heartbeat_late_s),
        (vehicle.motion.received if vehicle.motion else None, settings.position_late_s),
    )
    return any(heard is None or now - heard > limit for heard, limit in ages)


def _outside(place: Vector, settings: PX4Settings, who: str) -> str | None:
    if -place[2] > settings.max_altitude:
        return f"{who} above the altitude limit of {settings.max_altitude:g} m: {-place[2]:.1f} m"
    if (distance := math.hypot(place[0], place[1])) > settings.fence_radius:
        return f"{who} outside the fence of {settings.fence_radius:g} m: {distance:.1f} m away"
    return None
