"""Which velocity goes out to the base at each tick, and when it is zero whatever the plan says.

Standard library only: this runs in the Python of ROS, next to the robot's topics.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

__all__ = ["Refused", "Watchdog"]

ZERO = (0.0, 0.0)


class Refused(Exception):
    """A command that is not carried out."""


@dataclass
class Watchdog:
    """Passes the plan's velocity on while all is well, and zero for ever after it was not.

    A reason to stop is latched: nothing but a new :meth:`start` moves the base again. A plan that
    is silent while the base is at rest is no such reason: there is nothing to stop. Times are in
    seconds of a monotonic clock.

    Attributes:
        timeout: Longest time without a sign of life from the plan, in seconds.
        max_linear: Greatest speed that is accepted, in m/s.
        max_angular: Greatest turn rate that is accepted, in rad/s.
    """

    timeout: float = 0.5
    max_linear: float = 2.0
    max_angular: float = 4.0
    running: bool = field(default=False, init=False)
    reason: str = field(default="", init=False)
    _command: tuple[float, float] = field(default=ZERO, init=False)
    _alive: float = field(default=-math.inf, init=False)

    def start(self, now: float) -> None:
        """A run begins, at rest."""
        self.running, self.reason = True, ""
        self._command, self._alive = ZERO, now

    def command(self, linear: float, angular: float, now: float, sent: float | None = None) -> None:
        """The plan wants this velocity from now on (m/s, rad/s); also its sign of life.

        Args:
            linear: Speed ahead in m/s.
            angular: Turn rate to the left in rad/s.
            now: The time.
            sent: When the plan said so; it may have lain about while this process was held up.

        Raises:
            Refused: There is no run, it was stopped, or the velocity is late or out of bounds.
        """
        self._expire(now)
        late = now - (now if sent is None else sent)
        if late > self.timeout:
            self.trip(f"a command has come {late:.2f} s late")
        if self.reason or not self.running:
            raise Refused(self.reason or "no run was started")
        for value, most, unit in (
            (linear, self.max_linear, "m/s"),
            (angular, self.max_angular, "rad/s"),
        ):
            if not abs(value) <= most:  # also for NaN
                self.trip(f"a velocity of {value:g} {unit} is asked for; the limit is {most:g}")
                raise Refused(self.reason)
        self._command, self._alive = (linear, angular), now

    def alive(self, now: float) -> None:
        """The plan is alive, and its last command stays in force."""
        self._expire(now)
        self._alive = now

    @property
    def moving(self) -> bool:
        """Whether the velocity in force is not zero."""
        return self._command != ZERO

    def trip(self, reason: str) -> bool:
        """Stop, and stay stopped; whether this is the first reason of the run, which is kept."""
        self._command = ZERO
        if self.reason or not self.running:
            return False
        self.reason = reason
        return True

    def stop(self) -> None:
        """The run is over: stay at rest until the next one."""
        self.running = False
        self._command = ZERO

    def velocity(self, now: float) -> tuple[float, float]:
        """What to publish now (m/s, rad/s)."""
        self._expire(now)
        return self._command

    def _expire(self, now: float) -> None:
        """Stop a base whose plan is silent, also when its next message is here by now."""
        if self.moving and now - self._alive > self.timeout:
            self.trip(f"the plan has given no sign of life for {now - self._alive:.2f} s")
