"""A PX4 multicopter over MAVLink, as a robot that runs verified plans."""

from __future__ import annotations

import contextlib
import importlib.util
import threading
from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

from vaso.errors import MissingDependencyError, RobotError
from vaso.execution import Health, Period
from vaso.modules.robots.driver_process import DriverProcess
from vaso.modules.robots.px4_settings import PX4Settings
from vaso.plan.transition_system import Scalar
from vaso.platforms import Issued, Platform, get_platform

__all__ = ["PX4Mavlink"]

DRIVER = "vaso.modules.robots.px4_driver"
PERIOD_S = 600.0  # a bound against waiting for ever: the driver ends every period much sooner
SLACK_S = 10.0  # what a driver may need beyond the times in its settings
SILENT_S = 2.0  # the driver speaks ten times a second


class PX4Mavlink:
    """Flies a PX4 multicopter in offboard mode. Implements :class:`vaso.execution.Robot`.

    A driver process owns the connection and streams set-points at 20 Hz on its own clock. It keeps
    the vehicle on the path that the plan's velocities mean, waits for a climb off the ground, and
    lands when the path comes back to the ground. It also lands when anything goes wrong:
    ``docs/robots/px4.md`` has the list.

    Time is the vehicle's own (``time_boot_ms``). What is measured comes from LOCAL_POSITION_NED,
    from the take-off point: ``altitude``, ``max_altitude``, ``linear_velocity``, and ``x``, ``y``,
    ``z`` (north, east, down). Altitude and velocity are 0 on the ground. ``velocity_change`` is a
    property of the commands, as in the platform: from one to the next.

    Args:
        connect: Where the vehicle is, as in
            :class:`~vaso.modules.robots.px4_settings.PX4Settings`.
        flight_log: File for the telemetry, as JSON lines; by default a new file in ``runs``, named
            after the time.
        on_event: Called with what a person should be told, such as why arming is refused.
        settings: Any other field of ``PX4Settings``.

    Attributes:
        on_event: As above; may be set at any time.

    Raises:
        RobotError: A setting is unknown or has no sense.
    """

    is_simulated = False

    def __init__(
        self,
        connect: str = PX4Settings.url,
        *,
        flight_log: str | Path | None = None,
        on_event: Callable[[str], None] | None = None,
        **settings: Any,
    ) -> None:
        self.platform: Platform = get_platform("px4")
        self.name = f"px4 at {connect}"
        log = flight_log or Path("runs", f"px4-{datetime.now():%Y%m%d-%H%M%S}.jsonl")
        try:
            self.settings = PX4Settings(
                url=connect, flight_log=str(Path(log).absolute()), **settings
            )
        except (TypeError, ValueError) as error:
            raise RobotError(f"{self.name}: {error}") from error
        self.on_event = on_event
        self._driver: DriverProcess | None = None
        self._asked: int | None = None
        self._measured: dict[str, float] = {}
        self._details: dict[str, Scalar] = {}
        self._stopping = threading.Lock()
        self._stopped = False

    @property
    def flight_log(self) -> Path:
        """The file with the telemetry."""
        return Path(self.settings.flight_log or "")

    @property
    def driver_pid(self) -> int | None:
        """Process id of the driver, while there is one."""
        return self._driver.pid if self._driver is not None else None

    def connect(self) -> None:
        """Start the driver, and wait for the heartbeat of a PX4 multicopter.

        Raises:
            MissingDependencyError: pymavlink is not installed.
            RobotError: Nothing is heard, or it is no PX4 multicopter.
        """
        if importlib.util.find_spec("pymavlink") is None:
            raise MissingDependencyError("pymavlink", "px4")
        self._driver = DriverProcess(
            DRIVER,
            self.settings.as_dict(),
            name="the px4 driver",
            silence_s=SILENT_S,
            on_event=self._hear,
        )
        self._driver.start()
        self._driver.call("connect", self.settings.connect_s + SLACK_S)

    def start(self) -> None:
        """Wait until the vehicle is ready, enter offboard mode, and arm.

        Raises:
            RobotError: It does not get ready, or refuses; the reason is what it says itself.
        """
        answer = self._link.call("start", self.settings.ready_s + SLACK_S)
        self._measured = answer["measured"]

    def read(self, sensor: str) -> Scalar:
        """The platform has no sensors.

        Raises:
            RobotError: Always.
        """
        raise RobotError(f"{self.name} has no sensor {sensor}")

    def act(self, command: Issued) -> None:
        """Put a velocity in force for the period that begins now.

        Raises:
            RobotError: It is no command of the platform. A velocity outside the limits, or the
                loss of the vehicle, is raised by :meth:`wait`.
        """
        if command.name != "set_velocity":
            raise RobotError(f"{self.name} has no command {command.name}")
        velocity = command["velocity"]
        self._asked = self._link.ask("act", velocity=velocity, period=self.platform.dt)

    def wait(self) -> Period:
        """Wait for the end of the period.

        It ends late where the vehicle lags behind a climb off the ground, and where the path ends
        on the ground: then it ends when the vehicle has landed and has disarmed itself.

        Raises:
            RobotError: The vehicle, its control or the driver was lost; the vehicle lands.
        """
        if self._asked is None:
            raise RobotError(f"{self.name}: there is no command to wait for")
        number, self._asked = self._asked, None
        answer = self._link.answer(number, PERIOD_S, "act")
        self._measured = answer["measured"]
        return Period(answer["time"], answer["seconds"], answer["overrun"])

    def measured(self) -> Mapping[str, float]:
        """The numbers at the end of the last period."""
        return self._measured

    def stop(self, reason: str = "") -> None:
        """Land where the vehicle is, and return when it has disarmed, or obeys somebody else."""
        with self._stopping:
            if self._driver is None or self._stopped:
                return
            limit = self.settings.land_s + SLACK_S
            try:
                state = self._driver.call("stop", limit, reason=reason)["state"]
                self._details = _details(state)
            except RobotError as error:
                self._details = _details(self._driver.state) | {"stop": str(error)}
            self._stopped = True

    def health(self) -> Health:
        """What driver and vehicle say; ``flight_log`` is the file with the telemetry."""
        details: dict[str, Scalar] = {"flight_log": str(self.flight_log)}
        if self._driver is None:
            return Health(False, ("it is not connected",), details)
        state = self._driver.state
        problems = [state["fault"]] if state.get("fault") else []
        try:
            self._driver.check()
        except RobotError as error:
            problems.append(f"{error.message}; PX4's own failsafe lands the vehicle")
        return Health(not problems, tuple(problems), details | (self._details or _details(state)))

    def close(self) -> None:
        """Let go of the vehicle. A driver that still has to land it goes on without VASO."""
        self.stop("closed")
        if self._driver is not None:
            with contextlib.suppress(OSError):
                self._driver.close(SLACK_S if self._landed else 1.0)
            self._driver = None

    @property
    def _landed(self) -> bool:
        return not self._details.get("armed", True)

    @property
    def _link(self) -> DriverProcess:
        if self._driver is None:
            raise RobotError(f"{self.name} is not connected")
        return self._driver

    def _hear(self, event: Mapping[str, Any]) -> None:
        if self.on_event is not None:
            self.on_event(event["text"])


def _details(state: Mapping[str, Any]) -> dict[str, Scalar]:
    """The driver's state, as far as it belongs into a log."""
    wanted = ("phase", "fault", "armed", "mode", "altitude")
    return {k: state[k] for k in wanted if state.get(k) not in (None, "")}
