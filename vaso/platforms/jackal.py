"""Clearpath Jackal: a differential-drive ground robot driven by velocity commands at 10 Hz."""

from __future__ import annotations

from dataclasses import dataclass

from vaso.platforms.model import (
    Command,
    Issued,
    Parameter,
    Platform,
    PropositionSpec,
    SensorSpec,
)
from vaso.platforms.response import Channel, Response, Speed, Velocity


class JackalDynamics:
    """The base follows its command within a period, so the command is the state."""

    def initial(self) -> Issued:
        """Zero velocity."""
        return REST

    def step(self, state: Issued, command: Issued) -> Issued:
        """The command in force."""
        return command

    def truth(self, state: Issued) -> dict[str, bool | float]:
        """True propositions of a velocity command (m/s, rad/s; positive angular is to the left)."""
        motion = _Motion.of(state)
        return {
            "speed": abs(motion.linear),
            "turn_rate": motion.angular,
            "stop": motion.linear == 0 and motion.angular == 0,
            "forward": motion.linear > 0,
            "backward": motion.linear < 0,
            "turn_left": motion.linear == 0 and motion.angular > 0,
            "turn_right": motion.linear == 0 and motion.angular < 0,
        }


@dataclass(frozen=True)
class _Motion:
    linear: float
    angular: float

    @classmethod
    def of(cls, command: Issued) -> _Motion:
        linear, angular = command["linear"], command["angular"]
        assert isinstance(linear, float) and isinstance(angular, float)
        return cls(linear, angular)


VELOCITY = Command(
    name="velocity_publisher",
    parameters=(
        Parameter(name="linear", unit="m/s"),
        Parameter(name="angular", unit="rad/s", default=0.0),
    ),
    doc="Send linear and angular velocity commands.",
)
REST = VELOCITY.issue((0.0, 0.0), {})
RESPONSE = Response(
    channels=(
        Channel(name="linear", parameter="linear", acceleration=20.0),
        Channel(name="angular", parameter="angular", acceleration=25.0),
    ),
    quantities={"speed": Speed(channels=("linear",)), "turn_rate": Velocity(channel="angular")},
    source="max_acceleration in github.com/jackal/jackal, jackal_control/config/control.yaml",
)
ACTIONS = ("forward", "backward", "stop", "turn_left", "turn_right")

platform = Platform(
    name="jackal",
    description="Clearpath Jackal, a ground robot with velocity control and an object detector.",
    dt=0.1,
    commands=(VELOCITY,),
    sensors=(
        SensorSpec(
            name="yolo_listener",
            parameters=("object_name",),
            doc="Return True if the specified object is observed.",
        ),
    ),
    rest=REST,
    propositions=(
        *(
            PropositionSpec(name=a, kind="action", phrase=f"the command is {a.replace('_', ' ')}")
            for a in ACTIONS
        ),
        PropositionSpec(name="speed", kind="numeric", unit="m/s", minimum=0.0),
        PropositionSpec(name="turn_rate", kind="numeric", unit="rad/s"),
        PropositionSpec(
            name="people_observed",
            kind="observation",
            phrase="people are observed",
            sensor="yolo_listener('people')",
        ),
        PropositionSpec(
            name="person_observed",
            kind="observation",
            phrase="a person is observed",
            sensor="yolo_listener('people')",
        ),
        PropositionSpec(
            name="obstacle_observed",
            kind="observation",
            phrase="an obstacle is observed",
            sensor="yolo_listener('obstacle')",
        ),
    ),
    exclusions=(ACTIONS,),
    dynamics=JackalDynamics(),
    response=RESPONSE,
    margins={"speed": 0.02, "turn_rate": 0.04},  # 4 % of 0.5 m/s and of 1 rad/s: wheels, slip
)
