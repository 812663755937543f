"""Settings of the PX4 adapter: where the vehicle is, how it is flown, and what it may not do."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, fields
from typing import Any

__all__ = ["PX4Settings"]


@dataclass(frozen=True)
class PX4Settings:
    """What the driver goes by. Lengths in metres, speeds in m/s, times in seconds.

    Attributes:
        url: Where the vehicle is: ``udp:HOST:PORT`` listens there, ``udpout:HOST:PORT`` speaks
            first, ``tcp:HOST:PORT``, or a serial device with its speed, ``/dev/ttyACM0:57600``.
        system: MAVLink system id of the vehicle; None for the first multicopter that is heard.
        flight_log: File for the telemetry; None for none.
        rate_hz: Set-points a second. PX4 leaves offboard mode below 2.
        connect_s: How long to wait for a vehicle.
        ready_s: How long to wait until it has a position, is in offboard mode and is armed.
        speed_limit: Commands faster than this are refused.
        correction: The most that keeping to the path may add to a commanded velocity.
        tracking_speed: Corrections do not make the vehicle faster than this.
        max_altitude: Altitude above the take-off point at which the vehicle is landed.
        fence_radius: Horizontal distance from there at which it is landed.
        position_late_s: While the last position is older than this, the vehicle stands still.
        position_lost_s: After so long without a position it is landed.
        heartbeat_late_s: While the last heartbeat is older than this, the vehicle stands still.
        heartbeat_lost_s: After so long without a heartbeat it is landed.
        stall_s: How long the plan may leave the vehicle without a command, hovering, before it is
            landed.
        first_s: The same between arming and the first command.
        silence_s: How long VASO's process may be silent before the vehicle is landed.
        held_up_s: A gap in the stream of set-points so long that PX4 may be about to end offboard
            mode (``COM_OF_LOSS_T``): the vehicle is landed, and the stream does not go on.
        climb_s: How long the vehicle may lag behind while it takes off; the period waits.
        land_s: How long a landing may take, until the vehicle has disarmed itself.
        give_up_s: How long the driver, left alone, tries to land a vehicle that it cannot hear.
    """

    url: str = "udp:127.0.0.1:14540"
    system: int | None = None
    flight_log: str | None = None
    rate_hz: float = 20.0
    connect_s: float = 30.0
    ready_s: float = 60.0
    speed_limit: float = 2.0
    correction: float = 0.3
    tracking_speed: float = 0.9
    max_altitude: float = 12.0
    fence_radius: float = 30.0
    position_late_s: float = 0.5
    position_lost_s: float = 0.8
    heartbeat_late_s: float = 1.3
    heartbeat_lost_s: float = 2.5
    stall_s: float = 1.0
    first_s: float = 5.0
    silence_s: float = 1.0
    held_up_s: float = 0.8
    climb_s: float = 15.0
    land_s: float = 60.0
    give_up_s: float = 60.0

    def __post_init__(self) -> None:
        for f in fields(self):
            value = getattr(self, f.name)
            if f.type == "float" and not (
                isinstance(value, int | float) and math.isfinite(value) and value > 0
            ):
                raise ValueError(f"{f.name} must be a number above 0, and is {value!r}")
        if self.rate_hz < 10:
            raise ValueError(f"rate_hz must be at least 10, and is {self.rate_hz:g}")

    def as_dict(self) -> dict[str, Any]:
        """The settings by name, as JSON can carry them."""
        return asdict(self)
