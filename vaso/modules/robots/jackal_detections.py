"""What an object detector says, and whether that may still be gone by.

Standard library only: this runs in the Python of ROS, next to the robot's topics.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from vaso.modules.robots.jackal_messages import Detection, Report

__all__ = ["SYNONYMS", "Detections", "Stale"]

SYNONYMS: Mapping[str, tuple[str, ...]] = {
    "people": ("person", "pedestrian", "human"),
    "obstacle": (),
}
"""Further names that detectors have for what plans ask for; COCO says ``person``."""


class Stale(Exception):
    """A detector has said nothing, or nothing of use, for too long."""


@dataclass
class _Source:
    """The last word of one detector."""

    since: float
    report: Report | None = None
    received: float = -math.inf
    late: float = 0.0
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

    def expect(self, topic: str, now: float) -> None:
        """From now on, this topic counts as silent until something is said there."""
        self._sources.setdefault(topic, _Source(now))

    def add(self, topic: str, report: Report, now: float, clock: float | None = None) -> None:
        """Take in a report, which replaces the last one of the same source on the same topic.

        Args:
            topic: Where it was said.
            report: What it says.
            now: The time.
            clock: The same time on the clock of the report's stamp.
        """
        source = f"{topic} ({report.source})" if report.source else topic
        known = self._sources.setdefault(source, _Source(now))
        if source != topic and topic in self._sources and self._sources[topic].report is None:
            del self._sources[topic]  # nobody speaks there without a name
        late = 0.0
        if self.use_stamps and report.stamp is not None:
            late = max(0.0, (time.time() if clock is None else clock) - report.stamp)
        known.report, known.received = report, now - late
        known.late, known.problem = late, ""

    def reject(self, topic: str, problem: str, now: float) -> None:
        """Note a message that cannot be read; it does not count as a report."""
        self.expect(topic, now)
        self._sources[topic].problem = problem

    def observed(self, name: str, now: float) -> bool:
        """Whether some detector sees an object of a class.

        Raises:
            Stale: A detector that would have to say so is silent or late, or none ever would.
        """
        wanted = self._names(name)
        self._asked[name] = limit = _limit(self.ages, name, self.age)
        self._check(now, limit)
        reports = [s.report for s in self._sources.values() if s.report is not None]
        if not any(r.classes is None or wanted & set(map(_plain, r.classes)) for r in reports):
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


def _plain(name: str) -> str:
    return " ".join(name.replace("_", " ").replace("-", " ").lower().split())


def _all(reports: Sequence[Report]) -> Iterator[Detection]:
    for report in reports:
        yield from report.detections


def _silence(source: str, known: _Source, now: float, limit: float) -> str:
    if known.report is None:
        said = f"{source} has said nothing for {now - known.since:.1f} s"
    else:
        age = now - known.received
        said = f"the last report on {source} is {age:.2f} s old (limit {limit:g} s)"
        if known.late > limit:
            said += f"; by its stamp it came {known.late:.2f} s late: do the clocks agree?"
    return said + (f"; the last message cannot be read: {known.problem}" if known.problem else "")


def _told(reports: Sequence[Report]) -> str:
    known = sorted({c for r in reports for c in r.classes or ()})
    return f" (they report {', '.join(known)})" if known else ""
