"""What single messages of ROS topics say."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from vaso.monitoring.recorded.lines import Item, bad, number

__all__ = ["detected", "looks_like_detections", "names_of", "parts", "twist_of", "velocity"]

NANOSECONDS = 1e14
"""Times beyond this are counted in nanoseconds, as in ROS bags."""

SYNONYMS = {"people": ("person", "pedestrian", "human")}
LISTS = ("detections", "objects", "predictions", "results")
_SHAPE = '{"topic": …, "t": seconds, "msg": {…}}'


def parts(item: Item) -> tuple[str, float, Mapping[str, Any]]:
    """The topic, time in seconds, and fields of a message.

    Raises:
        VasoError: It is none.
    """
    data = item.data
    topic = data.get("topic")
    message = data.get("msg", data.get("message"))
    stamp = next((data[k] for k in ("t", "time", "timestamp", "stamp") if k in data), None)
    if not isinstance(topic, str) or not isinstance(message, dict) or stamp is None:
        raise bad(item, "this is no message of a topic", expected=_SHAPE)
    time = number(item, stamp, "its time")
    return topic, time * 1e-9 if abs(time) > NANOSECONDS else time, message


def twist_of(message: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """The twist in a ``Twist`` or ``TwistStamped``; None if it is neither."""
    inner = message.get("twist", message)
    if isinstance(inner, dict) and isinstance(inner.get("linear"), dict) and "angular" in inner:
        return inner
    return None


def velocity(item: Item, twist: object) -> tuple[float, float]:
    """Linear and angular velocity of a twist.

    Raises:
        VasoError: One of them is missing, or no finite number.
    """
    try:
        linear, angular = twist["linear"]["x"], twist["angular"]["z"]  # type: ignore[index]
    except (KeyError, TypeError, IndexError):
        raise bad(
            item, "a velocity is incomplete", expected='{"linear": {"x": …}, "angular": {"z": …}}'
        ) from None
    return number(item, linear, "linear.x"), number(item, angular, "angular.z")


def looks_like_detections(topic: str, message: Mapping[str, Any]) -> bool:
    """Whether a message is a detector's, by its fields, its topic's name, or its text."""
    text = message.get("data")
    if isinstance(message.get("detections"), list):
        return True
    if not isinstance(text, str):
        return False
    if any(word in topic.lower() for word in ("detect", "yolo")):
        return True
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        return False  # some other text, such as a robot's description
    return isinstance(data, dict) and any(isinstance(data.get(k), list) for k in LISTS)


def detected(item: Item, message: Mapping[str, Any], least: float) -> frozenset[str]:
    """The classes that a detector's message reports.

    Args:
        item: Where the message is, for errors.
        message: Its fields.
        least: Least score of a detection that counts.

    Raises:
        VasoError: It cannot be read. No part of it is used then: it could be a person.
    """
    if isinstance(message.get("detections"), list):
        return _hypotheses(item, message["detections"], least)
    if isinstance(message.get("data"), str):
        return _reported(item, message["data"], least)
    raise bad(item, "this is no message of a detector", expected="Detection2DArray or String")


def _hypotheses(item: Item, detections: Sequence[Any], least: float) -> frozenset[str]:
    """The classes in a ``vision_msgs/Detection2DArray``."""
    found = set()
    for detection in detections:
        if isinstance(detection, dict) and "results" not in detection:
            found |= _classes(item, [detection], least)
            continue
        results = detection.get("results") if isinstance(detection, dict) else None
        if not isinstance(results, list):
            raise bad(item, "a detection has no list of results")
        for result in results:
            holder = result.get("hypothesis", result) if isinstance(result, dict) else result
            found |= _classes(item, [holder], least)
    return frozenset(found)


def _reported(item: Item, text: str, least: float) -> frozenset[str]:
    """The classes in the JSON of a ``std_msgs/String``: a list, or an object with one."""
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise bad(
            item,
            "the text of a detector is no JSON",
            expected='{"detections": [{"class": "person", "score": 0.9}]}',
        ) from error
    if isinstance(data, dict):
        data = next((data[k] for k in LISTS if k in data), [data])
    if not isinstance(data, list):
        raise bad(item, "the text of a detector has no list of detections")
    return frozenset(_classes(item, data, least))


def _classes(item: Item, detections: Sequence[Any], least: float) -> set[str]:
    found = set()
    for detection in detections:
        if isinstance(detection, str):
            found.add(plain(detection))
            continue
        names = ("class", "label", "name", "class_name", "class_id", "id")
        name = (
            detection.get(next((k for k in names if k in detection), ""))
            if isinstance(detection, dict)
            else None
        )
        if not isinstance(name, str):
            raise bad(
                item, "a detection has no class", expected='{"class": "person", "score": 0.9}'
            )
        score = next((detection[k] for k in ("score", "confidence") if k in detection), 1.0)
        if number(item, score, "a score") >= least:
            found.add(plain(name))
    return found


def plain(name: str) -> str:
    """A class without case and punctuation."""
    return " ".join(name.replace("_", " ").replace("-", " ").lower().split())


def names_of(name: str) -> set[str]:
    """All names of a class, singular and plural."""
    asked = plain(name)
    names = {asked, *SYNONYMS.get(asked, ())}
    names |= {k for k, v in SYNONYMS.items() if asked in v}
    return names | {f"{n}s" for n in names} | {n.removesuffix("s") for n in names}
