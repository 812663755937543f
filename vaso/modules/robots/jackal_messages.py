"""What ROS messages say, as plain data.

Standard library only: messages are taken as objects with the attributes of their type.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeGuard

__all__ = ["Detection", "Report", "motion_of", "read_report", "report_of"]

_LISTS = ("detections", "objects", "predictions", "results")
_NAMES = ("class", "label", "name", "class_name", "class_id", "category", "object")
_SCORES = ("score", "confidence", "conf", "probability", "prob")
_STAMPS = ("stamp", "timestamp", "time")


@dataclass(frozen=True)
class Detection:
    """One object in one image.

    Attributes:
        name: Its class.
        score: How sure the detector is, from 0 to 1.
    """

    name: str
    score: float = 1.0


@dataclass(frozen=True)
class Report:
    """One message of a detector: everything that it sees in one image, which may be nothing.

    Attributes:
        detections: What it sees.
        stamp: When the image was taken, in seconds of the clock that :class:`Detections` is given
            as ``clock``; None if the message does not say.
        classes: All that this detector can see; None if the message does not say.
        source: Which of several detectors on one topic says so.
    """

    detections: tuple[Detection, ...] = ()
    stamp: float | None = None
    classes: frozenset[str] | None = None
    source: str = ""


def read_report(text: str) -> Report:
    """Read a detector's JSON.

    ``{"stamp": 1730000000.25, "classes": ["person", "chair"], "detections": [{"class": "person",
    "score": 0.91}]}`` says everything; a list of detections alone will do. A class may be called
    ``class``, ``label`` or ``name``, a score ``score`` or ``confidence``, and where there is no
    score it is 1. ``{"detections": {"person": 0.91}}`` and a ``vision_msgs/Detection2DArray`` as
    JSON will do, too. Several detectors on one topic tell themselves apart by ``source``. Other
    keys, such as bounding boxes, are ignored.

    Raises:
        ValueError: It is something else. No part of it is used then: the part that cannot be read
            could be a person.
    """
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"no JSON: {error}") from error
    if isinstance(data, list):
        return Report(tuple(_detections(data)))
    if not isinstance(data, dict):
        raise ValueError(f"neither a list nor an object, but {_short(data)}")
    rest = (_stamp(data), _classes(data), str(data.get("source") or ""))
    found = next((data[k] for k in _LISTS if k in data), None)
    if isinstance(found, dict):
        return Report(tuple(Detection(n, _score(s, found)) for n, s in found.items()), *rest)
    if isinstance(found, list):
        return Report(tuple(_detections(found)), *rest)
    if found is None and _first(data, _NAMES, str) is not None:
        return Report((_detection(data),), *rest)
    raise ValueError(f"no list of detections in {_short(data)}")


def _detections(data: Sequence[Any]) -> Iterator[Detection]:
    for each in data:
        if isinstance(each, dict) and isinstance(each.get("results"), list):  # a Detection2D
            for result in each["results"]:
                yield _detection(result.get("hypothesis") if isinstance(result, dict) else result)
        else:
            yield _detection(each)


def _detection(data: Any) -> Detection:
    if isinstance(data, str):
        return Detection(data)
    if not isinstance(data, dict):
        raise ValueError(f"no detection: {_short(data)}")
    name = _first(data, _NAMES, str)
    if not name:
        raise ValueError(f"a detection without a class: {_short(data)}")
    score = next((data[k] for k in _SCORES if k in data), 1.0)
    return Detection(name, _score(score, data))


def _score(value: Any, data: Any) -> float:
    try:
        score = float(value)
    except (TypeError, ValueError, OverflowError):
        score = math.nan
    if not 0 <= score <= 1:
        raise ValueError(f"a score that is not between 0 and 1: {_short(data)}")
    return score


def _stamp(data: Mapping[str, Any]) -> float | None:
    header = data.get("header")
    holder = header if isinstance(header, dict) else data
    value = next((holder[k] for k in _STAMPS if k in holder), None)
    if isinstance(value, dict):  # a builtin_interfaces/Time
        seconds, rest = value.get("sec"), value.get("nanosec", 0)
        value = seconds + rest * 1e-9 if _is_number(seconds) and _is_number(rest) else None
    return float(value) if _is_number(value) and value > 0 else None


def _is_number(value: Any) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and abs(value) < 1e18  # also for NaN


def _classes(data: Mapping[str, Any]) -> frozenset[str] | None:
    value = data.get("classes")
    if isinstance(value, list) and all(isinstance(v, str) for v in value):
        return frozenset(value)
    return None


def _first(data: Mapping[str, Any], keys: Sequence[str], kind: type) -> Any:
    return next((data[k] for k in keys if isinstance(data.get(k), kind)), None)


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False, default=repr)
    return text if len(text) <= 80 else text[:77] + "..."


def report_of(message: Any) -> Report:
    """A ``vision_msgs/Detection2DArray`` as a report; every hypothesis counts as a detection.

    Raises:
        ValueError: A score is not between 0 and 1.
    """
    stamp = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
    found = [r.hypothesis for detection in message.detections for r in detection.results]
    named = [(str(h.class_id), h.score) for h in found]
    detections = tuple(Detection(n, _score(s, [n, s])) for n, s in named)
    return Report(detections, stamp or None, source=str(message.header.frame_id))


def motion_of(message: Any) -> dict[str, float]:
    """Speed (m/s), turn rate (rad/s), position (m) and heading (rad) of a ``nav_msgs/Odometry``.

    Raises:
        ValueError: A number is not finite.
    """
    velocity, pose = message.twist.twist, message.pose.pose
    q = pose.orientation
    motion = {
        "speed": math.hypot(velocity.linear.x, velocity.linear.y),
        "turn_rate": velocity.angular.z,
        "x": pose.position.x,
        "y": pose.position.y,
        "heading": math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z)),
    }
    if not all(map(math.isfinite, motion.values())):
        raise ValueError(f"a number that is not finite: {motion}")
    return motion
