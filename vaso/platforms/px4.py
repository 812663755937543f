"""PX4 quadcopter: a multirotor that follows velocity set-points in the NED frame at 1 Hz.

NED means north, east, down: a negative third component climbs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from vaso.platforms.model import Command, Issued, Parameter, Platform, PropositionSpec
from vaso.platforms.response import Channel, Greatest, Position, Response, SetPoint, Speed

PERIOD = 1.0
NANO = 9


@dataclass(frozen=True, slots=True)
class Flight:
    """Height and motion at the end of a control period.

    Attributes:
        altitude: Metres above the ground, never negative.
        highest: The greatest altitude so far.
        velocity: Set-point in force (north, east, down) in m/s.
        change: Magnitude of the difference to the set-point before, in m/s.
    """

    altitude: float
    highest: float
    velocity: tuple[float, ...]
    change: float


class Px4Dynamics:
    """Integrates the vertical set-point; the ground carries a vehicle that has landed."""

    def initial(self) -> Flight:
        """On the ground, at rest."""
        return Flight(0.0, 0.0, (0.0, 0.0, 0.0), 0.0)

    def step(self, state: Flight, command: Issued) -> Flight:
        """One period under a velocity set-point: altitude falls by down x dt, at most to 0."""
        velocity = command["velocity"]
        assert isinstance(velocity, tuple)
        altitude = max(0.0, round(state.altitude - velocity[2] * PERIOD, NANO))
        change = math.dist(velocity, state.velocity)
        return Flight(altitude, max(state.highest, altitude), velocity, change)

    def truth(self, state: Flight) -> dict[str, bool | float]:
        """True propositions: metres, metres per second."""
        grounded = state.altitude == 0
        return {
            "altitude": state.altitude,
            "max_altitude": state.highest,
            "linear_velocity": 0.0 if grounded else math.hypot(*state.velocity),
            "velocity_change": state.change,
        }


VELOCITY = Command(
    name="set_velocity",
    parameters=(Parameter(name="velocity", unit="m/s, NED", size=3),),
    doc="Publish a velocity set-point (north, east, down) in metres per second, once per second.",
)

RESPONSE = Response(
    channels=(
        Channel(name="horizontal", parameter="velocity", components=(0, 1), lag=0.56),
        Channel(name="vertical", parameter="velocity", components=(2,), lag=0.25),
    ),
    quantities={
        "altitude": Position(channel="vertical", factor=-1.0, floor=0.0),
        "max_altitude": Greatest(of="altitude"),
        "linear_velocity": Speed(channels=("horizontal", "vertical"), unless_on="altitude"),
        "velocity_change": SetPoint(),
    },
    source="PX4, PositionControl::_velocityControl: the acceleration is the error of the velocity "
    "times MPC_XY_VEL_P_ACC (1.8 1/s by default, lag 0.56 s) or MPC_Z_VEL_P_ACC (4 1/s, 0.25 s)",
)

platform = Platform(
    name="px4",
    description="PX4 quadcopter in offboard mode, flown by NED velocity set-points at 1 Hz.",
    dt=PERIOD,
    commands=(VELOCITY,),
    rest=VELOCITY.issue(((0.0, 0.0, 0.0),), {}),
    propositions=(
        PropositionSpec(name="altitude", kind="numeric", unit="m", minimum=0.0),
        PropositionSpec(name="max_altitude", kind="numeric", unit="m", minimum=0.0),
        PropositionSpec(name="linear_velocity", kind="numeric", unit="m/s", minimum=0.0),
        PropositionSpec(name="velocity_change", kind="numeric", unit="m/s", minimum=0.0),
    ),
    dynamics=Px4Dynamics(),
    response=RESPONSE,
    recoveries=tuple(VELOCITY.issue(((0.0, 0.0, down),), {}) for down in (0.3, 1.0)),
    accuracy={"altitude": 0.3, "max_altitude": 0.3, "linear_velocity": 0.1},  # of the estimator
    trajectory="set_velocity",
    history_names=("plan", "trajectory", "traj", "vel_traj", "velocities", "history"),
    current_names=("v", "velocity", "current", "curr", "vel", "cmd"),
    previous_names=("previous", "prev", "v_prev", "previous_velocity", "last"),
)
