"""A Clearpath Jackal over ROS 2, as a robot that runs verified plans."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

from vaso.errors import RobotError, StaleReadingError
from vaso.execution.robot import Health, Period
from vaso.modules.robots.driver_process import DriverProcess
from vaso.modules.robots.jackal_settings import DEFAULT_TOPIC, JackalSettings
from vaso.modules.robots.ros_environment import find_ros
from vaso.plan.transition_system import Scalar
from vaso.platforms import Issued, Platform, get_platform
from vaso.platforms.reading import read_call

__all__ = ["JackalROS"]

ALIVE_S = 0.05
ON_TIME_S = 0.005
ANSWER_S = 1.0
STANDSTILL = 0.02  # m/s and rad/s, as odometry has noise


class JackalROS:
    """A Jackal that is driven over ROS 2.

    ROS runs in a driver process, in an environment of its own; nothing of ROS is imported here. The
    driver publishes the plan's velocity at 20 Hz, and zero, for good, when the plan stalls or dies,
    a detector falls silent, the emergency stop is pressed, or nothing listens any more. A second
    process publishes zero when the driver dies. See ``docs/robots/jackal.md``.

    Args:
        connect: The velocity topic; further settings may follow as in a URL:
            ``/j100_0000/cmd_vel?stamped=false``.
        settings: Settings by name; see :class:`~.jackal_settings.JackalSettings`.

    Raises:
        RobotError: A setting does not exist, or does not fit.
    """

    is_simulated = False

    def __init__(self, connect: str = DEFAULT_TOPIC, **settings: Any) -> None:
        self.settings = JackalSettings.read(connect, settings)
        self.platform: Platform = get_platform("jackal")
        self.name = f"jackal at {self.settings.velocity_topic}"
        self._driver: DriverProcess | None = None
        self._command = self.platform.rest
        self._started = self._begun = self._due = self._acted = 0.0
        self._running = False

    @property
    def driver_pid(self) -> int | None:
        """Process id of the driver."""
        return self._driver.pid if self._driver else None

    def connect(self) -> None:
        """Start the driver, and wait until the base listens and every detector has spoken.

        Raises:
            RobotError: There is no environment for ROS, or somebody is missing; says who.
        """
        if self._driver is not None:
            return
        ros = find_ros(self.settings.python)
        domain = self.settings.domain
        driver = DriverProcess(
            "vaso.modules.robots.jackal_node",
            self.settings.for_driver(),
            name="the jackal driver",
            python=ros.python,
            env={**ros.env, **({} if domain is None else {"ROS_DOMAIN_ID": str(domain)})},
        )
        self._driver = driver
        try:
            driver.start()
            self._wait_for_robot(driver)
        except BaseException:
            self.close()
            raise

    def start(self) -> None:
        """Begin a run, at rest.

        Raises:
            RobotError: Something is wrong with the robot.
        """
        self._connected().check()
        if missing := self._missing():
            raise RobotError(f"{self.name}: {'; '.join(missing)}")
        self._command = self.platform.rest
        self._call("start")
        self._running = True
        self._started = self._begun = self._due = self._acted = time.monotonic()

    def read(self, sensor: str) -> Scalar:
        """Whether the detectors see an object now.

        Raises:
            StaleReadingError: A detector is silent or late, or none reports such objects.
            RobotError: There is no such sensor, or the driver has gone.
        """
        call = read_call(sensor)
        if call is None or call[0] != "yolo_listener":
            raise RobotError(f"the jackal has no sensor {sensor}", expected="yolo_listener('...')")
        named = {**dict(zip(("object_name",), call[1], strict=False)), **call[2]}
        return bool(self._call("read", name=str(named.get("object_name", "")))["value"])

    def act(self, command: Issued) -> None:
        """Put a velocity in force.

        Raises:
            RobotError: It is out of bounds, or the driver has stopped the base.
        """
        if command.name != "velocity_publisher":
            raise RobotError(
                f"the jackal has no command {command.name}", expected="velocity_publisher"
            )
        now = time.monotonic()  # all processes of a computer share this clock
        self._call("command", linear=command["linear"], angular=command["angular"], sent=now)
        self._command, self._acted = command, now

    def wait(self) -> Period:
        """Let the rest of the period pass.

        Raises:
            RobotError: The driver has stopped the base meanwhile, or has gone.
        """
        driver, dt = self._connected(), self.platform.dt
        due = self._due + dt
        end = due if self._acted < due else self._acted + dt  # a late command has its time, too
        while (left := end - time.monotonic()) > 0:
            self._check(driver)
            driver.send("alive")
            time.sleep(min(left, ALIVE_S))
        self._check(driver)
        now = time.monotonic()
        is_late = now - due > ON_TIME_S
        period = Period(now - self._started, now - self._begun, now - due if is_late else 0.0)
        self._begun, self._due = now, now if is_late else due
        return period

    def measured(self) -> Mapping[str, float]:
        """Speed (m/s), turn rate (rad/s) and pose of odometry; else the speed that is commanded.

        Raises:
            StaleReadingError: There was odometry, and it is too old now.
        """
        odometry, age = self._odometry()
        if age is None:
            truth = self.platform.dynamics.truth(self._command)
            return {name: float(truth[name]) for name in ("speed", "turn_rate")}
        if age > self.settings.odometry_age:
            raise StaleReadingError(
                f"the last odometry on {self.settings.topics['odometry_topic']} is {age:.2f} s old "
                f"(limit {self.settings.odometry_age:g} s)"
            )
        return odometry

    def stop(self, reason: str = "") -> None:
        """Publish zero and wait until odometry says that the base stands still."""
        driver, self._running = self._driver, False
        self._command = self.platform.rest
        if driver is None:
            return
        try:
            driver.call("stop", ANSWER_S)
            self._until(self._stands_still, 2.0)
        except RobotError:  # the driver has gone; its guard stops the base
            return

    def health(self) -> Health:
        """Who listens and who speaks, and what is wrong."""
        if self._driver is None:
            return Health(ok=False, problems=("it is not connected",))
        state = self._driver.state
        problems = [*self._missing(), *([state["reason"]] if state.get("reason") else [])]
        try:
            self._driver.check()
        except RobotError as error:
            problems.append(error.message)
        return Health(ok=not problems, problems=tuple(problems), details=_details(state))

    def close(self) -> None:
        """Let go of the base; the driver publishes zero first if there was a run."""
        if self._driver is not None:
            self._driver.close(3.0)
            self._driver = None
        self._running = False

    def _connected(self) -> DriverProcess:
        if self._driver is None:
            raise RobotError(f"{self.name} is not connected", hint="call connect() first")
        return self._driver

    def _call(self, kind: str, **fields: Any) -> dict[str, Any]:
        return self._connected().call(kind, ANSWER_S, **fields)

    def _check(self, driver: DriverProcess) -> None:
        """Raise if the base was stopped by the driver, or the driver has gone."""
        driver.check()
        state = driver.state
        if state.get("reason"):
            raise (StaleReadingError if state["stale"] else RobotError)(state["reason"])
        if not self._running:
            raise RobotError("the jackal was stopped")

    def _wait_for_robot(self, driver: DriverProcess) -> None:
        self._until(lambda: bool(driver.state) and not self._missing(), self.settings.patience)
        missing = self._missing()
        if missing:
            raise RobotError(
                f"{self.name}: {'; '.join(missing)} (waited {self.settings.patience:g} s)",
                hint=self._hint(driver),
            )

    def _until(self, done: Callable[[], bool], seconds: float) -> None:
        end = time.monotonic() + seconds
        while not done() and time.monotonic() < end:
            self._connected().check()
            time.sleep(0.02)

    def _missing(self) -> list[str]:
        """What the robot lacks to be driven."""
        state = self._driver.state if self._driver else {}
        if not state:
            return ["the driver has said nothing yet"]
        found = [] if state["listeners"] else ["nothing subscribes to its velocity topic"]
        found += [
            f"no detections have come on {topic}"
            for topic, age in state["detectors"].items()
            if age is None
        ]
        return found + (["the emergency stop is pressed"] if state["emergency"] else [])

    def _hint(self, driver: DriverProcess) -> str:
        """What to look at when somebody is missing."""
        wanted = "TwistStamped" if self.settings.stamped else "Twist"
        types = driver.call("types", ANSWER_S)["types"]
        if types and not driver.state["listeners"]:
            other = str(not self.settings.stamped).lower()
            return f"it takes {', '.join(types)}, not {wanted}: set stamped={other}"
        if not driver.state["listeners"]:
            return "is it on the same ROS_DOMAIN_ID, and this its topic? (ros2 topic list)"
        return "start the detector; a skill without sensors runs with the setting detections="

    def _odometry(self) -> tuple[dict[str, float], float | None]:
        state = self._connected().state
        return dict(state.get("odometry", {})), state.get("odometry_age")

    def _stands_still(self) -> bool:
        odometry, age = self._odometry()
        if age is None or age > self.settings.odometry_age:
            return True  # it cannot be seen
        return odometry["speed"] < STANDSTILL and abs(odometry["turn_rate"]) < STANDSTILL


def _details(state: Mapping[str, Any]) -> dict[str, Scalar]:
    if not state:
        return {}
    age = state["odometry_age"]
    detectors = {f"age of {t} (s)": _age(a) for t, a in state["detectors"].items()}
    return {
        "listeners": state["listeners"],
        "other publishers of velocities": state["rivals"],
        "emergency stop": state["emergency"],
        "age of odometry (s)": _age(age),
        **detectors,
    }


def _age(seconds: float | None) -> Scalar:
    return "never heard" if seconds is None else round(seconds, 3)
