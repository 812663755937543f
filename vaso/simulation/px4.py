"""A quadcopter that follows velocity set-points in wind: lag, drag, take-off ramp, ground."""

from __future__ import annotations

import math
from collections.abc import Mapping

from vaso.errors import RobotError
from vaso.execution import Health, Period
from vaso.platforms import Issued, get_platform
from vaso.simulation.autopilot import AIRBORNE, LEAST_CLIMB, ZERO, TakeOff, Tracker
from vaso.simulation.multirotor import Body, Multirotor
from vaso.simulation.scene import AirScene
from vaso.simulation.truth import FlightMoment, FlightTruth, Vector
from vaso.simulation.wind import Gusts, settle

__all__ = ["PX4Sim"]

_SUBSTEP = 0.02
_TRACK = 0.1
_LANDING = 0.7
"""Speed of PX4's own landing in m/s (``MPC_LAND_SPEED``)."""

_LONGEST_LANDING = 3600.0
_LONGEST_CLIMB = 15.0
"""Seconds after which a vehicle that has not come off the ground has failed to."""


class PX4Sim:
    """A simulated PX4 quadcopter, headless and seeded; implements :class:`vaso.execution.Robot`.

    Args:
        scene: Take-off point and wind; by default still air.
        seed: Of the wind.
        tracking: Whether set-points pass through the adapter's position loop
            (:class:`~vaso.simulation.autopilot.Tracker`); False sends them as they are, and shows
            how far take-off, drag and wind carry a vehicle that is flown open loop.
        body: What the vehicle can do.
        take_off: PX4's take-off ramp; False lifts off at once.

    Attributes:
        scene: The scene as it is for this seed.
    """

    is_simulated = True

    def __init__(
        self,
        scene: AirScene | None = None,
        *,
        seed: int = 0,
        tracking: bool = True,
        body: Body | None = None,
        take_off: bool = True,
    ) -> None:
        self.name = f"px4 simulator (seed {seed})"
        self.platform = get_platform("px4")
        self.seed = seed
        self.tracking = tracking
        given = scene or AirScene()
        self.scene = given.model_copy(update={"wind": settle(given.wind, seed)})
        self.body = body or Body.of(self.platform)
        self._ramped = take_off
        self._ready = self._closed = False
        self._setpoint: Vector = ZERO
        self._reset()

    def connect(self) -> None:
        """Nothing to reach."""
        if self._closed:
            raise RobotError("this simulator has been closed", hint="make a new one")

    def start(self) -> None:
        """Stand at the take-off point, armed, in offboard mode; time 0."""
        self.connect()
        self._reset()
        self._ready = True

    def read(self, sensor: str) -> bool:
        """The vehicle has no sensors that a plan can read.

        Raises:
            RobotError: Always.
        """
        raise RobotError(f"the simulated PX4 has no sensor {sensor}")

    def act(self, command: Issued) -> None:
        """Put a velocity set-point in force.

        Raises:
            RobotError: It is another command, not finite, or the vehicle has not been started.
        """
        self._require_ready()
        try:
            velocity = command["velocity"]
        except KeyError:
            raise RobotError(f"the PX4 does not know the command {command}") from None
        if (
            not isinstance(velocity, tuple)
            or len(velocity) != 3
            or not all(math.isfinite(v) for v in velocity)
        ):
            raise RobotError(
                f"the PX4 cannot follow {command}", expected="three finite numbers in m/s"
            )
        after: Vector = (float(velocity[0]), float(velocity[1]), float(velocity[2]))
        self._change = math.dist(after, self._setpoint)
        self._setpoint = after

    def wait(self) -> Period:
        """Let one control period pass; one that begins a take-off waits for it, if tracking.

        Raises:
            RobotError: The vehicle has not been started, or does not come off the ground.
        """
        self._require_ready()
        begin = self._time
        if self.tracking and self._tracker.lifts_off(self._setpoint):
            self._lift_off()
        waited = self._time - begin
        self._pass()
        self._change_seen, self._change = self._change, 0.0
        return Period(
            time=self._moments[-1].time,
            seconds=round(self.platform.dt + waited, 9),
            overrun=round(waited, 9),
        )

    def measured(self) -> Mapping[str, float]:
        """True altitude (m), speed (m/s) and change of set-point; besides, NED position (m).

        ``max_altitude`` is the greatest altitude so far, between samples too.
        """
        here = self._moments[-1]
        return {
            "altitude": here.altitude,
            "max_altitude": here.highest,
            "linear_velocity": here.speed,
            "velocity_change": self._change_seen,
            "x": here.north,
            "y": here.east,
            "z": 0.0 - here.altitude,
        }

    def stop(self, reason: str = "") -> None:
        """Land where it is, and disarm."""
        if not self._ready:
            return
        self._ready = False
        self._landing = True
        position = self._vehicle.position
        self._tracker = Tracker((position[0], position[1], 0.0), touchdown=_LANDING)
        self._setpoint = ZERO
        end = self._moments[-1].time + _LONGEST_LANDING
        while not self._vehicle.is_on_ground and self._moments[-1].time < end:
            self._pass()

    def health(self) -> Health:
        """Always well; the details say where it is."""
        here = self._moments[-1]
        return Health(
            ok=True,
            details={
                "time": here.time,
                "altitude": here.altitude,
                "is_on_ground": here.is_on_ground,
                "armed": self._ready,
            },
        )

    def close(self) -> None:
        """Let go of it; it lands first."""
        self.stop()
        self._closed = True

    @property
    def truth(self) -> FlightTruth:
        """What really happened so far."""
        return FlightTruth(
            scene=self.scene,
            seed=self.seed,
            dt=self.platform.dt,
            tracking=self.tracking,
            moments=tuple(self._moments),
            track=tuple(self._track),
            touchdowns=tuple(self._vehicle.touchdowns),
        )

    def _require_ready(self) -> None:
        if not self._ready:
            raise RobotError("the simulator has not been started, or has been stopped")

    def _reset(self) -> None:
        start = (*self.scene.take_off, 0.0)
        self._gusts = Gusts(self.scene.wind, self.seed)
        ramp = TakeOff(self.body.lags[1]) if self._ramped else None
        self._vehicle = Multirotor(self.body, start, ramp)
        self._tracker = Tracker(start)
        self._setpoint = ZERO
        self._change = self._change_seen = 0.0
        self._landing = False
        self._moments: list[FlightMoment] = []
        self._track: list[tuple[float, float, float, float]] = []
        self._steps = 0
        self._track.append((0.0, *self._vehicle.position))
        self._note()

    def _lift_off(self) -> None:
        """Climb until the vehicle is off the ground. The nominal path waits meanwhile."""
        climb = (0.0, 0.0, min(self._setpoint[2], -LEAST_CLIMB))
        for _ in range(round(_LONGEST_CLIMB / _SUBSTEP)):
            if self._vehicle.position[2] > AIRBORNE:
                return
            self._step(climb)
        raise RobotError(f"the vehicle has not climbed within {_LONGEST_CLIMB:g} s")

    def _pass(self) -> None:
        """One control period in sub-steps."""
        for _ in range(round(self.platform.dt / _SUBSTEP)):
            self._tracker.advance(self._setpoint, _SUBSTEP)
            wanted = self._setpoint
            if self.tracking or self._landing:
                wanted = self._tracker.steer(self._setpoint, self._vehicle.position)
            self._step(wanted)
        self._note()

    def _step(self, wanted: Vector) -> None:
        """One sub-step under the velocity that is sent to the vehicle."""
        self._gusts.blow(_SUBSTEP)
        self._vehicle.follow(wanted, self._gusts.now, _SUBSTEP)
        self._steps += 1
        if self._steps % round(_TRACK / _SUBSTEP) == 0:
            self._track.append((self._time, *self._vehicle.position))

    @property
    def _time(self) -> float:
        return round(self._steps * _SUBSTEP, 9)

    def _note(self) -> None:
        number, vehicle = len(self._moments), self._vehicle
        north, east, altitude = vehicle.position
        self._moments.append(
            FlightMoment(
                step=number,
                time=self._time,
                north=north,
                east=east,
                altitude=altitude,
                velocity=vehicle.velocity,
                setpoint=self._setpoint,
                reference=self._tracker.reference,
                wind=self._gusts.now,
                highest=vehicle.highest,
                is_on_ground=vehicle.is_on_ground,
                after_stop=self._landing,
            )
        )
