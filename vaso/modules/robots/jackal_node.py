"""The Jackal's driver: a process in the Python of ROS that stands between a plan and the base.

It publishes the plan's velocity at 20 Hz for as long as the plan is alive, the detectors speak, the
base listens and the emergency stop is not pressed; else zero. When VASO's process goes, it
publishes zero and ends. When it goes itself, :mod:`.jackal_guard` publishes zero.
"""

from __future__ import annotations

import signal
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Protocol

from vaso.errors import RobotError
from vaso.modules.robots.driver_process import DriverProcess
from vaso.modules.robots.jackal_detections import Detections, Stale
from vaso.modules.robots.jackal_watchdog import Refused, Watchdog
from vaso.modules.robots.link import Channel, LinkClosed, Message, connect_back

if TYPE_CHECKING:
    from vaso.modules.robots.jackal_topics import Topics

__all__ = ["JackalDriver", "main"]

TICK_S = 0.05
FAREWELL_S = 0.5  # how long zero is published before the driver ends
REST_S = 1.0  # how long zero is published after a run


class Base(Protocol):
    """What the driver needs of ROS: :class:`~vaso.modules.robots.jackal_topics.Topics`."""

    @property
    def problem(self) -> str: ...
    @property
    def listeners(self) -> int: ...
    @property
    def rivals(self) -> int: ...
    @property
    def emergency(self) -> bool: ...
    def publish(self, linear: float, angular: float) -> None: ...
    def odometry(self, now: float) -> tuple[dict[str, float], float]: ...
    def other_types(self) -> list[str]: ...


class Guardian(Protocol):
    """The link to the guard: :class:`~vaso.modules.robots.driver_process.DriverProcess`."""

    @property
    def state(self) -> Message: ...
    def send(self, kind: str) -> None: ...
    def check(self) -> None: ...


class JackalDriver:
    """Answers VASO, and decides at every tick which velocity goes out.

    Args:
        channel: The link to VASO.
        base: The robot's topics.
        detections: What detectors say; ``base`` writes into it.
        settings: As :class:`~vaso.modules.robots.jackal_settings.JackalSettings` has them.
        lock: Held while ``base`` writes.
        guard: Is told ``tick`` or ``idle``.
    """

    def __init__(
        self,
        channel: Channel,
        base: Base,
        detections: Detections,
        settings: Message,
        lock: threading.Lock,
        guard: Guardian,
    ) -> None:
        self.watchdog = Watchdog(
            settings["command_timeout"], settings["max_linear"], settings["max_angular"]
        )
        self._channel = channel
        self._base = base
        self._detections = detections
        self._settings = settings
        self._lock = lock
        self._guard = guard
        self._publish_until = 0.0
        self._stale = False
        self.terminated = False

    def run(self) -> None:
        """Serve until VASO goes or this process is told to end; at rest then."""
        due = time.monotonic()
        try:
            while not self.terminated:
                for message in self._channel.receive(due - time.monotonic()):
                    self.handle(message)
                if (now := time.monotonic()) >= due:
                    self.tick(now)
                    due = max(due + TICK_S, now)
        except LinkClosed:
            self.watchdog.trip("VASO has gone")
        finally:
            self.rest(FAREWELL_S)

    def tick(self, now: float) -> None:
        """Look for reasons to stop, publish, and tell VASO."""
        self._look(now, self.watchdog.moving)
        self._publish(now)
        self._channel.send("state", **self.state(now))

    def rest(self, seconds: float) -> None:
        """Publish zero for a while, if the base was ever commanded."""
        self.watchdog.stop()
        end = time.monotonic() + seconds
        while self._publish_until and time.monotonic() < end:
            self._base.publish(0.0, 0.0)
            self._guard.send("tick")
            time.sleep(TICK_S)
        self._guard.send("idle")

    def handle(self, message: Message) -> None:
        """Carry out one message from VASO."""
        now = time.monotonic()
        match message["kind"]:
            case "alive":
                self.watchdog.alive(now)
            case "command":
                self._command(message, now)
            case "read":
                self._read(message, now)
            case "start":
                self._start(message, now)
            case "types":
                self._channel.answer(message, types=self._base.other_types())
            case "stop":
                self.watchdog.stop()
                self._publish_until = min(self._publish_until, now + REST_S)
                self._publish(now)
                self._done(message, now)

    def state(self, now: float) -> Message:
        """What VASO is told at every tick."""
        with self._lock:
            ages = self._detections.ages_now(now)
            odometry, age = self._base.odometry(now)
        linear, angular = self.watchdog.velocity(now)
        return {
            "running": self.watchdog.running,
            "reason": self.watchdog.reason,
            "stale": self._stale,
            "velocity": [linear, angular],
            # A base that the guard does not reach yet could not be stopped by it.
            "listeners": min(self._base.listeners, int(self._guard.state.get("listeners", 0))),
            "rivals": self._base.rivals,
            "detectors": ages,
            "emergency": self._base.emergency,
            "odometry": odometry,
            "odometry_age": age if odometry else None,
        }

    def _start(self, message: Message, now: float) -> None:
        self._stale = False
        self.watchdog.start(now)
        self._publish_until = float("inf")
        self._look(now, moving=False)
        self._publish(now)
        self._done(message, now)

    def _done(self, message: Message, now: float) -> None:
        """Answer, after the state that has come of it."""
        self._channel.send("state", **self.state(now))
        self._channel.answer(message)

    def _command(self, message: Message, now: float) -> None:
        linear, angular = message["linear"], message["angular"]
        self._look(now, moving=bool(linear or angular))
        try:
            self.watchdog.command(linear, angular, now, message.get("sent"))
        except Refused as refused:
            name = "StaleReadingError" if self._stale else "RobotError"
            self._channel.refuse(message, str(refused), name=name)
        else:
            self._channel.answer(message)
        self._publish(now)

    def _read(self, message: Message, now: float) -> None:
        try:
            with self._lock:
                value = self._detections.observed(message["name"], now)
        except Stale as stale:
            self._channel.refuse(message, str(stale), name="StaleReadingError")
        else:
            self._channel.answer(message, value=value)

    def _look(self, now: float, moving: bool) -> None:
        """Stop the base if something is wrong that the plan may not know of.

        Args:
            now: The time.
            moving: Whether the base moves, or is about to: at rest, nobody needs a detector.
        """
        if self._base.emergency:
            self.watchdog.trip("the emergency stop is pressed")
        if self._base.problem:
            self.watchdog.trip(self._base.problem)
        try:
            self._guard.check()
        except RobotError as error:
            self.watchdog.trip(error.message)
        if not self._base.listeners:
            self.watchdog.trip(f"nothing listens to {self._settings['velocity_topic']} any more")
        if moving and self._settings["needs_detections"]:
            try:
                with self._lock:
                    self._detections.check(now)
            except Stale as stale:
                self._stale |= self.watchdog.trip(str(stale))

    def _publish(self, now: float) -> None:
        if now < self._publish_until:
            self._base.publish(*self.watchdog.velocity(now))
        self._guard.send("tick" if now < self._publish_until else "idle")


def main() -> None:
    """The process: start the guard and ROS, say hello, serve."""
    channel, settings = connect_back()
    guard = DriverProcess(
        "vaso.modules.robots.jackal_guard", settings, name="the guard", python=sys.executable
    )
    try:
        with ThreadPoolExecutor(1) as pool:
            guarding = pool.submit(guard.start)
            driver, topics = _driver(channel, settings, guard)
            guarding.result()
    except ImportError as error:
        sys.exit(f"{error} in {sys.executable}; use an installation of ROS that has it")
    except RobotError as error:
        sys.exit(str(error))
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, lambda *_: setattr(driver, "terminated", True))
    channel.send("hello")
    driver.run()
    topics.close()
    guard.close(2.0)


def _driver(
    channel: Channel, settings: Message, guard: DriverProcess
) -> tuple[JackalDriver, Topics]:
    from vaso.modules.robots.jackal_topics import Topics

    limits = ("confidence", "confidences", "age", "ages", "synonyms", "use_stamps")
    detections = Detections(**{name: settings[name] for name in limits})
    lock = threading.Lock()
    topics = Topics(settings, detections, lock)
    return JackalDriver(channel, topics, detections, settings, lock, guard), topics


if __name__ == "__main__":
    main()
