"""Settings of a Jackal: its topics, limits and time-outs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self
from urllib.parse import parse_qsl

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from vaso.errors import RobotError
from vaso.modules.robots.jackal_detections import SYNONYMS

__all__ = ["DEFAULT_TOPIC", "JackalSettings"]

DEFAULT_TOPIC = "/j100_0000/cmd_vel"


class JackalSettings(BaseModel):
    """Settings of a Jackal. The defaults are those of Clearpath's ROS 2 Jazzy packages.

    A topic that is None is the usual one in the namespace of the velocity topic; an empty one is
    not used.

    Attributes:
        velocity_topic: Where velocities are published.
        stamped: Whether as geometry_msgs/TwistStamped (Jazzy) or as Twist (Humble).
        zero_stamps: Leave the stamps of velocities at zero, for a base whose clock differs from
            this computer's: it then takes its own time.
        detections: Topic of std_msgs/String with JSON; ``<namespace>/detections``, unless
            ``detections_2d`` is given.
        detections_2d: Topic of vision_msgs/Detection2DArray; not used by default.
        odometry_topic: Topic of nav_msgs/Odometry; ``<namespace>/platform/odom/filtered``.
        emergency_topic: Topic of std_msgs/Bool; ``<namespace>/platform/emergency_stop``.
        confidence: Least score of a detection that counts.
        confidences: The same for single classes.
        age: Greatest age of a detector's report, in seconds.
        ages: The same for single classes.
        synonyms: Names that a detector has for what plans ask for; added to the usual ones.
        use_stamps: Whether a report's age counts from its own stamp, where it has one.
        odometry_age: Greatest age of odometry, in seconds.
        command_timeout: Longest time without a sign of life from the plan, in seconds.
        max_linear: Greatest speed that is accepted, in m/s.
        max_angular: Greatest turn rate that is accepted, in rad/s.
        patience: How long to wait for the robot when connecting, in seconds.
        python: Python of the ROS environment; None for the one that was set up.
        domain: ROS_DOMAIN_ID; None for that of the environment.
        use_sim_time: Whether time is that of a simulator (``/clock``).
    """

    model_config = ConfigDict(frozen=True, extra="forbid")
    velocity_topic: str = DEFAULT_TOPIC
    stamped: bool = True
    zero_stamps: bool = False
    detections: str | None = None
    detections_2d: str = ""
    odometry_topic: str | None = None
    emergency_topic: str | None = None
    confidence: float = Field(default=0.5, ge=0, le=1)
    confidences: Mapping[str, float] = Field(default_factory=dict)
    age: float = Field(default=0.5, gt=0, le=10)
    ages: Mapping[str, float] = Field(default_factory=dict)
    synonyms: Mapping[str, tuple[str, ...]] = Field(default_factory=dict)
    use_stamps: bool = True
    odometry_age: float = Field(default=0.5, gt=0, le=10)
    command_timeout: float = Field(default=0.5, ge=0.2, le=1)
    max_linear: float = Field(default=2.0, gt=0, allow_inf_nan=False)
    max_angular: float = Field(default=4.0, gt=0, allow_inf_nan=False)
    patience: float = Field(default=10.0, gt=0, allow_inf_nan=False)
    python: str | None = None
    domain: int | None = Field(default=None, ge=0, le=232)
    use_sim_time: bool = False

    @classmethod
    def read(cls, connect: str, further: Mapping[str, Any]) -> Self:
        """Settings from a velocity topic, with others as in a URL.

        Args:
            connect: For example ``/j100_0000/cmd_vel?stamped=false&detections=/yolo``.
            further: More settings, which come first.

        Raises:
            RobotError: There is no such setting, or a value does not fit.
        """
        topic, _, query = connect.partition("?")
        given: dict[str, Any] = {"velocity_topic": topic or DEFAULT_TOPIC}
        given |= _nested(parse_qsl(query, keep_blank_values=True))
        try:
            return cls.model_validate({**given, **further})
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            name = ".".join(str(p) for p in first["loc"])
            problem = first["msg"].removeprefix("Value error, ")
            raise RobotError(
                f"setting of the jackal: {name + ': ' if name else ''}{problem}",
                source=connect,
                expected=f"a velocity topic such as {DEFAULT_TOPIC}?stamped=false; settings are "
                + ", ".join(cls.model_fields),
            ) from error

    @model_validator(mode="after")
    def _complete(self) -> Self:
        for limits, most in ((self.confidences, 1.0), (self.ages, 60.0)):
            for name, value in limits.items():
                if not 0 <= value <= most:
                    raise ValueError(f"{name}: {value:g} is not between 0 and {most:g}")
        for name, topic in self.topics.items():
            if topic and (not topic.startswith("/") or topic.endswith("/") or " " in topic):
                raise ValueError(f"{name}: '{topic}' is no absolute topic such as {DEFAULT_TOPIC}")
        if not self.velocity_topic:
            raise ValueError("there is no velocity topic")
        return self

    @property
    def namespace(self) -> str:
        """The namespace of the velocity topic, ``/j100_0000``; empty for ``/cmd_vel``."""
        return self.velocity_topic.rpartition("/")[0]

    @property
    def topics(self) -> dict[str, str]:
        """All topics; those that are not used are empty."""
        usual = {
            "detections": "detections",
            "odometry_topic": "platform/odom/filtered",
            "emergency_topic": "platform/emergency_stop",
        }
        given = {name: getattr(self, name) for name in usual}
        if self.detections_2d and self.detections is None:
            given["detections"] = ""
        return {
            "velocity_topic": self.velocity_topic,
            "detections_2d": self.detections_2d,
            **{
                name: f"{self.namespace}/{usual[name]}" if topic is None else topic
                for name, topic in given.items()
            },
        }

    @property
    def detectors(self) -> list[str]:
        """Topics on which detectors must speak."""
        return [t for t in (self.topics["detections"], self.topics["detections_2d"]) if t]

    def for_driver(self) -> dict[str, Any]:
        """What the driver needs, as JSON can carry it."""
        return {
            **self.model_dump(mode="json", exclude={"python", "domain", "patience"}),
            **self.topics,
            "synonyms": {**SYNONYMS, **self.synonyms},
            "needs_detections": bool(self.detectors),
        }


def _nested(pairs: list[tuple[str, str]]) -> dict[str, Any]:
    """``ages.people=0.3`` as ``{"ages": {"people": "0.3"}}``."""
    found: dict[str, Any] = {}
    for key, value in pairs:
        outer, dot, inner = key.partition(".")
        if not dot:
            found[outer] = value
        elif outer == "synonyms":
            found.setdefault(outer, {})[inner] = tuple(value.split(","))
        else:
            found.setdefault(outer, {})[inner] = value
    return found
