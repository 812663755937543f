"""A flight from arming to disarming, one tick at a time.

A tick looks at the vehicle, resumes the sequence that runs, moves the nominal path on, and sends
one set-point. Requests are answered through :attr:`Flight.answers` when what they ask for is done.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator, Sequence
from enum import StrEnum
from typing import Any

from vaso.modules.robots.px4_checks import Fault, command_fault, flight_fault, is_late
from vaso.modules.robots.px4_following import STILL, Following
from vaso.modules.robots.px4_log import FlightLog
from vaso.modules.robots.px4_mavlink import LAND, OFFBOARD, M, Vehicle
from vaso.modules.robots.px4_path import SetPoint, Vector
from vaso.modules.robots.px4_sequences import UNHEARD_S, SequenceError, arming, finding, landing
from vaso.modules.robots.px4_settings import PX4Settings
from vaso.modules.robots.px4_track import Track

__all__ = ["Flight", "Phase"]

ALIVE_S = 1.0
KEEP_S = 1.0  # how long set-points go on while AUTO.LAND is asked for


class Phase(StrEnum):
    """Where a flight is."""

    IDLE = "idle"
    FINDING = "finding"
    ARMING = "arming"
    FLYING = "flying"
    LANDING = "landing"
    LANDED = "landed"
    LOST = "lost"  # to a pilot or a failsafe: nothing is sent any more


class Flight:
    """Flies a vehicle.

    Args:
        vehicle: The vehicle.
        settings: How.
        log: Where events are written.

    Attributes:
        answers: What has been done, as (request, fields); fields with ``error`` are refusals.
        events: What a person should be told.
        fault: Why the flight has ended early; None if it has not.
    """

    def __init__(self, vehicle: Vehicle, settings: PX4Settings, log: FlightLog) -> None:
        self.phase = Phase.IDLE
        self.fault: Fault | None = None
        self.answers: deque[tuple[str, dict[str, Any]]] = deque()
        self.events: deque[str] = deque()
        self.track = Track(vehicle)
        self._vehicle = vehicle
        self._settings = settings
        self._log = log
        self._following = Following(self.track, settings)
        self._stream: SetPoint | None = None
        self._sequence: Iterator[None] | None = None
        self._waiting: tuple[Vector, float] | None = None
        self._alive_at = 0.0
        self._landing_since = self._sent_at = 0.0

    # requests

    def find(self) -> None:
        """Begin to look for the vehicle; answered as ``connect``."""
        self.phase = Phase.FINDING
        self._sequence = finding(self._vehicle, self._settings)

    def prepare(self) -> None:
        """Begin to arm; answered as ``start``."""
        self.phase = Phase.ARMING
        self._sequence = arming(self._vehicle, self._settings, self._be_still, self.tell)

    def command(self, velocity: Sequence[float], period: float) -> None:
        """Put a velocity in force for a period; answered as ``act`` at its end."""
        problem = command_fault(velocity, period, self._settings, self._following.path)
        if self.phase not in (Phase.FLYING, Phase.LANDED):
            problem = self.fault.text if self.fault else f"the vehicle is {self.phase}"
        if problem is not None:
            self.answers.append(("act", {"error": problem}))
            self.fail(Fault(problem))
            return
        wanted = (velocity[0], velocity[1], velocity[2])
        rises = self._following.path.end_of(wanted, period)[2] < 0
        if self.phase is Phase.LANDED and rises:
            self._waiting = (wanted, period)  # a second take-off: arm again first
            self.prepare()
        else:
            self._following.begin(wanted, period)

    def land(self) -> None:
        """Begin to land, wherever the vehicle is; answered as ``stop`` when it is safe."""
        if self.phase in (Phase.FLYING, Phase.ARMING) and self._vehicle.may_be_armed:
            self._begin_landing("land")
        elif self.phase in (Phase.FINDING, Phase.ARMING):
            self._rest(Phase.IDLE)

    @property
    def is_safe(self) -> bool:
        """Whether there is nothing left to do for the vehicle."""
        return self.phase in (Phase.IDLE, Phase.FINDING, Phase.LANDED, Phase.LOST)

    def fail(self, fault: Fault) -> None:
        """End the flight early: land, or let go of a vehicle that somebody else controls."""
        if self.phase in (Phase.LANDING, Phase.LANDED, Phase.LOST) and self.fault is not None:
            return
        self.fault = self.fault or fault
        self.tell(fault.text)
        self._refuse(fault.text)
        if not fault.is_ours:
            self._rest(Phase.LOST)
        elif self._vehicle.may_be_armed and self.phase is not Phase.LANDING:
            self._begin_landing(fault.text)
            if fault.is_deaf:
                self._stream = None
        elif not self._vehicle.may_be_armed:
            self._rest(Phase.LANDED if self.track.airborne else Phase.IDLE)

    def tell(self, text: str) -> None:
        """Tell the user, and the log."""
        self.events.append(text)
        self._log.write("VASO", {"event": text})

    # a tick

    def tick(self) -> None:
        """Do what is due now."""
        now = time.monotonic()
        if now >= self._alive_at:
            self._alive_at = now + ALIVE_S
            self._vehicle.say_alive()
        passed = self.track.observe()
        if self.phase is Phase.FLYING:
            self._fly(passed)
        elif self.phase is Phase.LANDED:
            self._stand(passed, now)
        if self._stream is not None and now - self._sent_at > self._settings.held_up_s:
            held_up = f"the driver was held up for {now - self._sent_at:.1f} s"
            self.fail(Fault(held_up, is_deaf=True))
        if self._sequence is not None:
            self._resume(now)
        self._send()

    def _stand(self, passed: float, now: float) -> None:
        """On the ground, periods only pass."""
        self._following.stand(passed)
        self._end_period()
        if self._vehicle.heard is None or now - self._vehicle.heard > UNHEARD_S:
            self._refuse("the vehicle has landed and is not heard any more")

    def _resume(self, now: float) -> None:
        """Resume the sequence that runs."""
        assert self._sequence is not None
        if self.phase is Phase.LANDING:
            self._while_landing(now)
        if self._sequence is None:
            return
        try:
            next(self._sequence)
        except StopIteration:
            self._sequence = None
            self._finished()
        except SequenceError as error:
            self._sequence = None
            self._refuse(error.text, error.hint)
            self._given_up(error.text)

    def _finished(self) -> None:
        match self.phase:
            case Phase.FINDING:
                self.phase = Phase.IDLE
                self.answers.append(("connect", {}))
            case Phase.ARMING:
                self._take_over()
            case Phase.LANDING if self._vehicle.may_be_armed:  # the sequence was broken off
                self._begin_landing("landing was interrupted")
            case Phase.LANDING:
                self._touch_down()

    def _given_up(self, text: str) -> None:
        """A sequence has failed: there is nothing to land, or landing goes on being tried."""
        self.fault = self.fault or Fault(text)
        self.tell(text)
        if self.phase is Phase.LANDING or self._vehicle.may_be_armed:
            self._begin_landing(text)
        else:
            self._rest(Phase.IDLE)

    def _take_over(self) -> None:
        """The vehicle is armed, in offboard mode and at rest."""
        self.track.set_home(anew=self._waiting is None)
        self.track.airborne = False
        self.phase = Phase.FLYING
        self._log.write("VASO", {"event": "armed", "home": self.track.home})
        self._following.wait_for_command()
        if self._waiting is None:
            self.answers.append(("start", {"measured": self._following.measured()}))
        else:
            self._following.begin(*self._waiting)
            self._waiting = None

    def _fly(self, passed: float) -> None:
        """Check, move the path on, and see whether the period is over."""
        place, following = self.track.place, self._following
        fault = flight_fault(self._vehicle, self._settings, place)
        if fault is not None and following.path.velocity[2] > 0 and self.track.has_come_down():
            self._touch_down()  # it noticed the ground before the path had reached it
        elif fault is not None:
            self.fail(fault)
        elif following.is_stalled:
            self.fail(Fault(f"no command has come for {following.idle_s:.1f} s"))
        elif following.has_waited_too_long:
            self.fail(Fault(f"the vehicle has not climbed within {self._settings.climb_s:g} s"))
        elif is_late(self._vehicle, self._settings):
            self._be_still()
        elif place is not None:
            following.move(passed, place)
            self._stream = following.stream
            self._end_period()

    def _end_period(self) -> None:
        """Answer the command in force, if its period is over; land where the path has."""
        following = self._following
        if not following.is_over:
            return
        if self.phase is Phase.FLYING and self.track.airborne and following.path.altitude <= 0:
            self._begin_landing("the path has reached the ground")
            return
        fields: dict[str, Any] = dict(following.end())
        self.answers.append(("act", {**fields, "measured": self._following.measured()}))

    # landing

    def _begin_landing(self, why: str) -> None:
        self._log.write("VASO", {"event": "landing", "why": why})
        self._vehicle.acks.pop(M.MAV_CMD_DO_SET_MODE, None)
        self.phase = Phase.LANDING
        self._landing_since = time.monotonic()
        if self._stream is not None:
            self._be_still()
        self._sequence = landing(self._vehicle, self._settings, lambda: self.track.airborne)

    def _while_landing(self, now: float) -> None:
        """Set-points end when AUTO.LAND is accepted, or the vehicle does not answer."""
        accepted = self._vehicle.acks.get(M.MAV_CMD_DO_SET_MODE) == M.MAV_RESULT_ACCEPTED
        if accepted or now - self._landing_since > KEEP_S or self._vehicle.mode != OFFBOARD:
            self._stream = None
        if self._vehicle.armed and self._vehicle.mode not in (OFFBOARD, LAND):
            mode = self._vehicle.mode
            self.fault = self.fault or Fault(f"a pilot or a failsafe has taken over: {mode}", False)
            self.tell(f"the vehicle is in {mode} now, and is left alone")
            self._refuse(self.fault.text)
            self._rest(Phase.LOST)

    def _touch_down(self) -> None:
        self._log.write("VASO", {"event": "landed"})
        self._following.path.touch_down()
        self._rest(Phase.LANDED)
        self._end_period()

    def _rest(self, phase: Phase) -> None:
        """Send nothing any more."""
        self.phase = phase
        self._stream = None
        self._sequence = None

    def _refuse(self, text: str, hint: str = "") -> None:
        """Refuse what waits for an answer."""
        for request in ("connect", "start", "act"):
            self.answers.append((request, {"error": text, "hint": hint}))
        self._following.drop()
        self._waiting = None

    # the stream

    def _be_still(self) -> None:
        self._stream = STILL

    def _send(self) -> None:
        self._sent_at = time.monotonic()
        if self._stream is None:
            return
        if self._stream.velocity is not None:
            self._vehicle.set_velocity(self._stream.velocity)
        elif self._stream.position is not None and self.track.home is not None:
            north, east, down = self._stream.position
            home = self.track.home
            self._vehicle.set_position((home[0] + north, home[1] + east, home[2] + down))
