"""Keeping a vehicle on its nominal path, period by period, on the vehicle's own clock."""

from __future__ import annotations

import math
import time

from vaso.modules.robots.px4_path import NominalPath, SetPoint, Vector
from vaso.modules.robots.px4_settings import PX4Settings
from vaso.modules.robots.px4_track import Track

__all__ = ["STILL", "Following"]

STILL = SetPoint(velocity=(0.0, 0.0, 0.0))
GRACE_S = 0.2  # between two commands, before the vehicle is held in place
CLIMB_LAG_M, CLIMB_LAG_S = 0.3, 0.6  # so far behind, and so many seconds, a climb may end


class Following:
    """Moves the nominal path on, and says what to stream and when a period is over.

    The path waits for a vehicle that takes off: motors spin up and ramps run for seconds before it
    climbs. It waits again at the end of a period of straight climb if the vehicle is too low.
    The period ends late then, which its ``overrun`` says.

    Args:
        track: Where the vehicle is.
        settings: Limits.

    Attributes:
        path: The nominal path.
        stream: The set-point to send.
    """

    def __init__(self, track: Track, settings: PX4Settings) -> None:
        self.path = NominalPath(settings.correction, settings.tracking_speed)
        self.stream = STILL
        self._track = track
        self._settings = settings
        self._period: _Period | None = None
        self._due: float | None = None
        self._last: Vector = (0.0, 0.0, 0.0)
        self._change = 0.0
        self._patience = settings.first_s
        self._idle_since = time.monotonic()

    @property
    def has_command(self) -> bool:
        """Whether a command is in force."""
        return self._period is not None

    @property
    def idle_s(self) -> float:
        """Seconds without a command."""
        return 0.0 if self.has_command else time.monotonic() - self._idle_since

    @property
    def is_stalled(self) -> bool:
        """Whether there has been no command for too long."""
        return self.idle_s > self._patience

    @property
    def has_waited_too_long(self) -> bool:
        """Whether the vehicle does not climb."""
        return self._period is not None and self._period.waited > self._settings.climb_s

    @property
    def is_over(self) -> bool:
        """Whether the period is over, and the vehicle about where it should be."""
        return self.has_command and self.path.left <= 0 and not self._is_too_low()

    def wait_for_command(self) -> None:
        """The vehicle is ready for its first command."""
        self._idle_since = time.monotonic()

    def begin(self, velocity: Vector, period: float) -> None:
        """Put a velocity in force, from where the last period should have ended if just now."""
        now = self._track.time
        late = now - self._due if self._due is not None else GRACE_S
        start = now - late if 0 <= late < GRACE_S else now
        self._period = _Period(start, period)
        self._change = math.dist(velocity, self._last)
        self._last = velocity
        self.path.begin(velocity, period)
        self.path.advance(now - start)

    def end(self) -> dict[str, float]:
        """End the period; returns its time, length and overrun in seconds."""
        assert self._period is not None
        now, period = self._track.time, self._period
        self.drop()
        self._due = period.due + period.waited
        self._patience = self._settings.stall_s
        late = max(0.0, now - period.due)
        return {"time": now, "seconds": now - period.start, "overrun": late}

    def measured(self) -> dict[str, float]:
        """The platform's numbers; ``velocity_change`` is from one command to the next."""
        return self._track.measured() | {"velocity_change": self._change}

    def drop(self) -> None:
        """No command is in force any more."""
        self._period = None
        self._idle_since = time.monotonic()

    def move(self, passed: float, place: Vector) -> None:
        """Let seconds pass for a vehicle that is at ``place``."""
        if not self._track.airborne:
            self._track.look_for_lift()
        if not self._track.airborne:
            self._on_the_ground(passed)
            return
        if self.has_command or self.idle_s > GRACE_S:
            self.stream = self.path.setpoint(place)
        if self.path.left > 0:
            self.path.advance(passed)
        else:
            self.path.settle(passed)
            if self._period is not None and self._is_too_low():
                self._period.waited += passed

    def stand(self, passed: float) -> None:
        """Let seconds pass for a vehicle that has landed."""
        self.path.advance(passed)

    def _on_the_ground(self, passed: float) -> None:
        """A position set-point would be above or below the ground, by the estimator's drift."""
        if self.path.stands or self.path.velocity[2] >= 0 or self._period is None:
            self.stream = STILL
            self.path.advance(passed)
        else:
            self.stream = self.path.climb()
            self._period.waited += passed

    def _is_too_low(self) -> bool:
        """Whether a straight climb has not reached its height, as while motors spin up."""
        north, east, down = self.path.velocity
        place = self._track.place
        if not self._track.airborne or down >= 0 or north or east or place is None:
            return False
        return place[2] - self.path.position[2] > CLIMB_LAG_M - CLIMB_LAG_S * down


class _Period:
    """A control period on the vehicle's clock: when it began, and when it should end."""

    def __init__(self, start: float, seconds: float) -> None:
        self.start = start
        self.due = start + seconds
        self.waited = 0.0
