"""Messages of ROS topics as a recording: velocities, odometry, detections.

A message is ``{"topic": "/cmd_vel", "t": 12.3, "msg": {…}}`` with the fields of its type as ROS
names them. What it is, its fields tell: ``Twist``, ``TwistStamped``, ``Odometry``,
``Detection2DArray``, or ``String`` with the JSON of a detector.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from vaso.errors import VasoError
from vaso.monitoring.recorded.lines import Item
from vaso.monitoring.recorded.recording import Recording, Sample, sample_count
from vaso.monitoring.recorded.ros_messages import (
    detected,
    looks_like_detections,
    names_of,
    parts,
    twist_of,
    velocity,
)
from vaso.platforms import Issued, Platform

__all__ = ["RosOptions", "is_ros", "ros_recording"]


@dataclass(frozen=True, slots=True)
class RosOptions:
    """How to read the messages of a bag.

    Attributes:
        velocity_topic: The topic with the velocity commands, where there are several.
        detection_topics: The topics of detectors; where none is given, they are told by their names
            and by what is in their messages.
        confidence: Least score of a detection that counts.
        age: Greatest age of a detector's report that is gone by, in seconds.
    """

    velocity_topic: str = ""
    detection_topics: tuple[str, ...] = ()
    confidence: float = 0.5
    age: float = 0.5


@dataclass
class _Streams:
    """Messages by what they are, each as (time, value)."""

    velocities: dict[str, list[tuple[float, float, float]]] = field(default_factory=dict)
    odometry: list[tuple[float, float, float]] = field(default_factory=list)
    detections: dict[str, list[tuple[float, frozenset[str]]]] = field(default_factory=dict)

    @property
    def times(self) -> Iterator[float]:
        """The time of every message that is used."""
        for velocities in self.velocities.values():
            yield from (entry[0] for entry in velocities)
        yield from (entry[0] for entry in self.odometry)
        for reports in self.detections.values():
            yield from (entry[0] for entry in reports)


def is_ros(data: Mapping[str, Any]) -> bool:
    """Whether a record is a message of a topic."""
    return "topic" in data and ("msg" in data or "message" in data)


def ros_recording(items: Sequence[Item], platform: Platform, options: RosOptions) -> Recording:
    """Resample messages to a platform's control period.

    The first sample is before the first command. The grid lies half a period off the commands, so
    that each of a loop that runs at the platform's rate falls into a period of its own.

    Raises:
        VasoError: A message is malformed, or there is no velocity in them.
    """
    streams = _Streams()
    for item in items:
        _sort_in(item, streams, options)
    streams.odometry.sort()
    for reports in streams.detections.values():
        reports.sort(key=lambda report: report[0])
    velocities = _chosen(streams.velocities, options.velocity_topic, items[0].source)
    dt, first = platform.dt, velocities[0][0]
    last = max(streams.times)
    count = sample_count(max(last - first, 0.0) + dt / 2, dt, items[0].source)
    samples = tuple(
        _sample(index, first + (index - 0.5) * dt, velocities, streams, platform, options)
        for index in range(count)
    )
    return Recording(items[0].source, "ROS messages", dt, samples)


def _sample(
    index: int,
    time: float,
    velocities: Sequence[tuple[float, float, float]],
    streams: _Streams,
    platform: Platform,
    options: RosOptions,
) -> Sample:
    found = _last(velocities, time)
    issued = platform.rest if found is None else _command(platform, found[1], found[2])
    measured = {}
    odometry = _last(streams.odometry, time)
    if odometry is not None and time - odometry[0] <= options.age:
        measured = {"speed": odometry[1], "turn_rate": odometry[2]}
    return Sample(
        time=round(index * platform.dt, 9),
        command=str(issued),
        issued=issued,
        sensors=_sensors(time, streams, platform, options),
        measured=measured,
    )


def _command(platform: Platform, linear: float, angular: float) -> Issued:
    command = next((c for c in platform.commands if len(c.parameters) == 2), None)
    if command is None:
        raise VasoError(
            f"the platform {platform.name} has no command for a linear and an angular velocity"
        )
    return command.issue((linear, angular), {})


class _Seen(dict[str, bool]):
    """Sensor readings that are made when they are asked for: any class can be asked for."""

    def __init__(self, sensor: str, seen: frozenset[str]) -> None:
        super().__init__()
        self._sensor, self._seen = sensor, seen

    def __missing__(self, key: str) -> bool:
        name = key.removeprefix(f"{self._sensor}('").removesuffix("')")
        return bool(names_of(name) & self._seen)

    def __bool__(self) -> bool:
        return True

    def __contains__(self, key: object) -> bool:
        return isinstance(key, str) and key.startswith(f"{self._sensor}('")


def _sensors(
    time: float, streams: _Streams, platform: Platform, options: RosOptions
) -> Mapping[str, bool]:
    """What every detector says; nothing where one of them is silent or late.

    Before its first report, a detector says what that report says, if it comes soon enough.
    """
    reports = [_last(stream, time) or stream[0] for stream in streams.detections.values()]
    fresh = [r[1] for r in reports if abs(time - r[0]) <= options.age]
    sensor = next((s.name for s in platform.sensors if len(s.parameters) == 1), None)
    if sensor is None or not reports or len(fresh) < len(reports):
        return {}
    return _Seen(sensor, frozenset().union(*fresh))


def _last(stream: Sequence[Any], time: float) -> Any:
    """The last entry that is not later than a time."""
    low, high = 0, len(stream)
    while low < high:
        middle = (low + high) // 2
        low, high = (middle + 1, high) if stream[middle][0] <= time + 1e-9 else (low, middle)
    return stream[low - 1] if low else None


def _sort_in(item: Item, streams: _Streams, options: RosOptions) -> None:
    """Put a message where it belongs; one of a type that says nothing here is left out."""
    topic, time, message = parts(item)
    twist = twist_of(message)
    if "pose" in message and isinstance(message.get("twist"), dict):
        inner = message["twist"].get("twist", message["twist"])
        linear, angular = velocity(item, inner)
        streams.odometry.append((time, abs(linear), angular))
    elif twist is not None:
        streams.velocities.setdefault(topic, []).append((time, *velocity(item, twist)))
    elif _is_detector(topic, message, options):
        seen = detected(item, message, options.confidence)
        streams.detections.setdefault(topic, []).append((time, seen))


def _is_detector(topic: str, message: Mapping[str, Any], options: RosOptions) -> bool:
    """Whether a message is a detector's: by its topic where that is given, else by its looks."""
    if options.detection_topics:
        return topic in options.detection_topics
    return looks_like_detections(topic, message)


def _chosen(
    velocities: Mapping[str, list[tuple[float, float, float]]], wanted: str, source: str
) -> list[tuple[float, float, float]]:
    """The velocity commands, in the order of time."""
    if not velocities or (wanted and wanted not in velocities):
        raise VasoError(
            f"there are no velocity commands{f' on {wanted}' if wanted else ''} in the log",
            source=source,
            expected="messages of type Twist or TwistStamped"
            + (f"; found on {', '.join(sorted(velocities))}" if velocities else ""),
        )
    if not wanted and len(velocities) > 1:
        raise VasoError(
            f"several topics carry velocities: {', '.join(sorted(velocities))}",
            source=source,
            hint="name the one that the plan's commands are on: --velocity-topic",
        )
    stream = velocities[wanted or next(iter(velocities))]
    return sorted(stream)
