"""What an object detector says, and whether that may still be gone by.

Standard library only: this runs in the Python of ROS, next to the robot's topics.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeGuard

__all__ = ["SYNONYMS", "Detection", "Detections", "Report", "Stale", "read_report"]

SYNONYMS: Mapping[str, tuple[str, ...]] = {
    "people": ("person", "pedestrian", "human"),
    "obstacle": (),
}
"""Further names that detectors have for what plans ask for; COCO says ``person``."""

_LISTS = ("detections", "objects", "predictions", "results")
_NAMES = ("class", "label", "name", "class_name", "class_id", "category", "object")
_SCORES = ("score", "confidence", "conf", "probability", "prob")
_STAMPS = ("stamp", "timestamp", "time")


class Stale(Exception):
    """A detector has said nothing, or nothing of use, for too long."""


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
    """

    detections: tuple[Detection, ...] = ()
    stamp: float | None = None
    classes: frozenset[str] | None = None


def read_report(text: str) -> Report:
    """Read a detector's JSON.

    ``{"stamp": 1730000000.25, "classes": ["person", "chair"], "detections": [{"class": "person",
    "score": 0.91}]}`` says everything; a list of detections alone will do. A class may be called
    ``class``, ``label`` or ``name``, a score ``score`` or ``confidence``, and where there is no
    score it is 1. Other keys, such as bounding boxes, are ignored.

    Raises:
        ValueError: It is something else. No part of it is used then: the part that cannot be read
            could be a person.
    """
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"no JSON: {error}") from error
    if isinstance(data, list):
        return Report(tuple(_detection(d) for d in data))
    if not isinstance(data, dict):
        raise ValueError(f"neither a list nor an object, but {_short(data)}")
    stamp, classes = _stamp(data), _classes(data)
    found = next((data[k] for k in _LISTS if k in data), None)
    if isinstance(found, list):
        return Report(tuple(_detection(d) for d in found), stamp, classes)
    if found is None and _first(data, _NAMES, str) is not None:
        return Report((_detection(data),), stamp, classes)
    raise ValueError(f"no list of detections in {_short(data)}")


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
    except (TypeError, ValueError):
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
    return isinstance(value, (int, float)) and math.isfinite(value)


def _classes(data: Mapping[str, Any]) -> frozenset[str] | None:
    value = data.get("classes")
    if isinstance(value, list) and all(isinstance(v, str) for v in value):
        return frozenset(_plain(v) for v in value)
    return None


def _first(data: Mapping[str, Any], keys: Sequence[str], kind: type) -> Any:
    return next((data[k] for k in keys if isinstance(data.get(k), kind)), None)


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False, default=repr)
    return text if len(text) <= 80 else text[:77] + "..."


def _plain(name: str) -> str:
    return " ".join(name.replace("_", " ").replace("-", " ").lower().split())


@dataclass
class _Source:
    """The last word of one detector."""

    since: float
    report: Report | None = None
    received: float = -math.inf
    problem: str = ""


@dataclass
class Detections:
    """What all detectors say, with limits of confidence and age.

    Times are in seconds of a monotonic clock.

    Attributes:
        confidence: Least score of a detection that counts.
        confidences: The same for single classes.
        age: Greatest age of a report that may be gone by, in seconds.
        ages: The same for single classes.
        synonyms: Further names of classes; see :data:`SYNONYMS`.
        use_stamps: Whether the age counts from a report's own stamp, where it has one.
    """

    confidence: float = 0.5
    confidences: Mapping[str, float] = field(default_factory=dict)
    age: float = 0.5
    ages: Mapping[str, float] = field(default_factory=dict)
    synonyms: Mapping[str, Sequence[str]] = field(default_factory=lambda: SYNONYMS)
    use_stamps: bool = True
    _sources: dict[str, _Source] = field(default_factory=dict, init=False)
    _asked: dict[str, float] = field(default_factory=dict, init=False)

    def expect(self, source: str, now: float) -> None:
        """From now on, this source counts as silent until it says something."""
        self._sources.setdefault(source, _Source(now))

    def add(self, source: str, report: Report, now: float, clock: float | None = None) -> None:
        """Take in a report.

        Args:
            source: Who says it, for example the topic.
            report: What it says.
            now: The time.
            clock: The same time on the clock of the report's stamp.
        """
        self.expect(source, now)
        known = self._sources[source]
        late = 0.0
        if self.use_stamps and report.stamp is not None:
            late = max(0.0, (time.time() if clock is None else clock) - report.stamp)
        known.report, known.received, known.problem = report, now - late, ""

    def reject(self, source: str, problem: str, now: float) -> None:
        """Note a message that cannot be read; it does not count as a report."""
        self.expect(source, now)
        self._sources[source].problem = problem

    def observed(self, name: str, now: float) -> bool:
        """Whether some detector sees an object of a class.

        Raises:
            Stale: A detector that would have to say so is silent or late, or none ever would.
        """
        wanted = self._names(name)
        self._asked[name] = limit = _limit(self.ages, name, self.age)
        self._check(now, limit)
        reports = [s.report for s in self._sources.values() if s.report is not None]
        if not any(r.classes is None or wanted & r.classes for r in reports):
            raise Stale(f"no detector reports '{name}'{_told(reports)}")
        least = _limit(self.confidences, name, self.confidence)
        return any(_plain(d.name) in wanted and d.score >= least for d in _all(reports))

    def check(self, now: float) -> None:
        """Check that every source has spoken lately, by the limits of the classes asked for so far.

        Raises:
            Stale: One has not; says which, and for how long.
        """
        self._check(now, min(self._asked.values(), default=self.age))

    def _check(self, now: float, limit: float) -> None:
        if not self._sources:
            raise Stale("there is no detector")
        for source, known in self._sources.items():
            if now - known.received > limit:
                raise Stale(_silence(source, known, now, limit))

    def ages_now(self, now: float) -> dict[str, float | None]:
        """The age of each source's last report in seconds; None if there was none."""
        return {
            name: None if s.report is None else now - s.received
            for name, s in self._sources.items()
        }

    def _names(self, name: str) -> frozenset[str]:
        """All names of a class, singular and plural."""
        plain = _plain(name)
        further = {_plain(k): v for k, v in self.synonyms.items()}.get(plain, ())
        names = {plain, *(_plain(n) for n in further)}
        return frozenset(names | {f"{n}s" for n in names} | {n.removesuffix("s") for n in names})


def _limit(single: Mapping[str, float], name: str, otherwise: float) -> float:
    return {_plain(k): v for k, v in single.items()}.get(_plain(name), otherwise)


def _all(reports: Sequence[Report]) -> Iterator[Detection]:
    for report in reports:
        yield from report.detections


def _silence(source: str, known: _Source, now: float, limit: float) -> str:
    if known.report is None:
        said = f"{source} has said nothing for {now - known.since:.1f} s"
    else:
        said = (
            f"the last report on {source} is {now - known.received:.2f} s old (limit {limit:g} s)"
        )
    return said + (f"; the last message cannot be read: {known.problem}" if known.problem else "")


def _told(reports: Sequence[Report]) -> str:
    known = sorted({c for r in reports for c in r.classes or ()})
    return f" (they report {', '.join(known)})" if known else ""
