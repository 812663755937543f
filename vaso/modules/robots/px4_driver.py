"""The driver process of a PX4 vehicle: it owns the MAVLink connection and streams set-points.

It lands the vehicle by itself when VASO's process dies, hangs, closes the link or says so, on
SIGINT and SIGTERM, and on any error of its own. If the driver dies, the stream of set-points ends
with it, and PX4's own failsafe for offboard loss takes over.
"""

from __future__ import annotations

import errno
import select
import signal
import time
from typing import Any

from vaso.modules.robots.link import Channel, LinkClosed, Message, connect_back
from vaso.modules.robots.px4_checks import Fault
from vaso.modules.robots.px4_flight import Flight
from vaso.modules.robots.px4_log import FlightLog
from vaso.modules.robots.px4_mavlink import Vehicle
from vaso.modules.robots.px4_sequences import UNHEARD_S
from vaso.modules.robots.px4_settings import PX4Settings

__all__ = ["Driver", "main"]

STATE_S = 0.1
RECOVER_S = 0.02  # after an error, against a loop without a pause


class Driver:
    """Serves one VASO process and one vehicle.

    Args:
        channel: The link to VASO.
        flight: What is flown.
        vehicle: On what.
        settings: How.
    """

    def __init__(
        self, channel: Channel, flight: Flight, vehicle: Vehicle, settings: PX4Settings
    ) -> None:
        self._channel = channel
        self._flight = flight
        self._vehicle = vehicle
        self._settings = settings
        self._requests: dict[str, Message] = {}
        self._alone_since: float | None = None
        self._ending = False
        self._tick_at = self._state_at = 0.0

    def interrupt(self, *_: object) -> None:
        """Land and end: what a signal does."""
        self._ending = True

    def run(self) -> None:
        """Until VASO has gone and the vehicle is safe."""
        while not self._is_done():
            for step in (self._sleep, self._hear, self._vehicle.receive, self._tick, self._tell):
                try:
                    step()
                except Exception as error:  # whatever it is, the vehicle has to come down
                    self._flight.fail(Fault(f"the driver has failed: {error!r}"))
                    time.sleep(RECOVER_S)

    def _tick(self) -> None:
        """What is due at the rate of the set-points."""
        now = time.monotonic()
        if now >= self._tick_at:
            self._tick_at = max(self._tick_at + 1 / self._settings.rate_hz, now)
            self._watch()
            self._flight.tick()

    def _sleep(self) -> None:
        """Until something has come, or the next tick."""
        sources: list[Any] = [s for s in (self._vehicle.fileno(),) if s is not None]
        if self._alone_since is None:
            sources.append(self._channel)
        select.select(sources, [], [], max(0.0, self._tick_at - time.monotonic()))

    def _hear(self) -> None:
        """Take VASO's requests."""
        if self._alone_since is not None:
            return
        try:
            for message in self._channel.receive():
                self._take(message)
        except LinkClosed:
            self._alone_since = time.monotonic()
            if not self._flight.is_safe:
                self._flight.fail(Fault("VASO's process has gone"))

    def _take(self, message: Message) -> None:
        kind = message["kind"]
        if "id" in message:
            self._requests[kind] = message
        match kind:
            case "connect":
                self._flight.find()
            case "start":
                self._flight.prepare()
            case "act":
                self._flight.command(message["velocity"], message["period"])
            case "stop":
                self._flight.land()

    def _watch(self) -> None:
        """Whether VASO still speaks, and whether a signal has come."""
        if self._flight.is_safe:
            return
        if self._alone_since is None and self._channel.silence > self._settings.silence_s:
            self._flight.fail(Fault(f"VASO has been silent for {self._channel.silence:.1f} s"))
        if self._ending:
            self._flight.fail(Fault("the driver was told to end"))

    def _tell(self) -> None:
        """Answers, events, and from time to time the state."""
        now, flight = time.monotonic(), self._flight
        while flight.answers:
            kind, fields = flight.answers.popleft()
            request = self._requests.pop(kind, None)
            if request is not None and "error" in fields:
                self._channel.refuse(request, fields["error"], hint=fields.get("hint", ""))
            elif request is not None:
                self._channel.answer(request, **fields)
        while flight.events:
            self._channel.send("event", text=flight.events.popleft())
        if "stop" in self._requests and (flight.is_safe or self._is_deaf(now)):
            self._channel.answer(self._requests.pop("stop"), state=self._state(now))
        if now >= self._state_at:
            self._channel.send("state", **self._state(now))
            self._state_at = now + STATE_S

    def _state(self, now: float) -> dict[str, Any]:
        vehicle, motion, fault = self._vehicle, self._vehicle.motion, self._flight.fault
        return {
            "phase": self._flight.phase,
            "fault": fault.text if fault is not None else "",
            "armed": vehicle.armed,
            "mode": str(vehicle.mode) if vehicle.found else "",
            "landed": vehicle.landed,
            "altitude": self._flight.track.altitude,
            "heartbeat_age": now - vehicle.heard if vehicle.heard is not None else None,
            "position_age": now - motion.received if motion is not None else None,
            "texts": list(vehicle.texts)[-3:],
        }

    def _is_deaf(self, now: float) -> bool:
        return self._vehicle.heard is None or now - self._vehicle.heard > UNHEARD_S

    def _is_done(self) -> bool:
        """Nobody is left to serve, and the vehicle is safe or has not been heard for long."""
        if self._ending and self._flight.is_safe:
            return True
        if self._alone_since is None:
            return False
        now = time.monotonic()
        alone = now - max(self._alone_since, self._vehicle.heard or 0.0)
        return self._flight.is_safe or alone > self._settings.give_up_s


def main() -> None:
    """Run the driver of the VASO process that has started this one."""
    channel, given = connect_back()
    settings = PX4Settings(**given)
    try:
        log = FlightLog(settings.flight_log)
    except OSError as error:
        raise SystemExit(f"the flight log cannot be written: {error}") from error
    try:
        vehicle = Vehicle(settings.url, log, settings.system)
    except (OSError, ValueError, OverflowError, ImportError) as error:
        raise SystemExit(f"{settings.url} cannot be opened: {error}{_remedy(error)}") from error
    driver = Driver(channel, Flight(vehicle, settings, log), vehicle, settings)
    signal.signal(signal.SIGINT, driver.interrupt)
    signal.signal(signal.SIGTERM, driver.interrupt)
    channel.send("hello")
    driver.run()
    log.close()


def _remedy(error: Exception) -> str:
    if isinstance(error, ImportError):
        return " (make everything)"
    if isinstance(error, OSError) and error.errno == errno.EADDRINUSE:
        return " (by another program, or by a driver that still lands a vehicle)"
    return ""


if __name__ == "__main__":
    main()
