"""What was true in a recording: every proposition that its rules speak of, as far as it is known.

In this order: what was measured; what the recording itself says; the platform's truth of the
command; the sensors that decide observations; and what the skill's labelling code reads from
sensors. What is left has no value, and a rule that needs it is not decided by it.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from vaso.errors import VasoError
from vaso.monitoring.recorded.recording import Recording, Sample
from vaso.plan.labelling import Labelling, Returned
from vaso.plan.transition_system import Label, Scalar
from vaso.platforms import Platform
from vaso.skill import Skill

__all__ = ["labelled"]


def labelled(
    recording: Recording,
    skill: Skill,
    platform: Platform,
    names: Collection[str],
    settings: Mapping[str, Scalar],
) -> list[dict[str, Label]]:
    """The propositions in each state of a recording.

    Args:
        recording: The recording.
        skill: Supplies the labelling code.
        platform: The robot's platform.
        names: The propositions that are needed.
        settings: Constants of the labelling code that the plan has set.

    Raises:
        LabellingError: The labelling code does not run.
    """
    rows = [dict(row) for row in _by_platform(recording, platform)]
    missing = {n for n in names if any(n not in row for row in rows)}
    if missing and any(sample.sensors for sample in recording.samples):
        _by_skill(recording, skill, platform, missing, settings, rows)
    return rows


def _by_platform(recording: Recording, platform: Platform) -> Iterator[dict[str, Label]]:
    dynamics = platform.dynamics
    world: Any = dynamics.initial()
    numeric = {p.name for p in platform.propositions if p.kind == "numeric"}
    for index, sample in enumerate(recording.samples):
        truth: dict[str, Label] = {}
        if sample.issued is not None:
            world = dynamics.step(world, sample.issued) if index else world
            truth = dynamics.truth(world)
        if sample.measured:  # the model of a platform that was measured says nothing more
            truth = {n: v for n, v in truth.items() if isinstance(v, bool)}
        measured = {n: float(v) for n, v in sample.measured.items() if n in numeric}
        row = {**truth, **_observed(sample, platform), **sample.labels, **measured}
        yield {name: value for name, value in row.items() if math.isfinite(value)}


def _observed(sample: Sample, platform: Platform) -> dict[str, Label]:
    return {
        p.name: bool(sample.sensors[p.sensor])
        for p in platform.propositions
        if p.sensor is not None and p.sensor in sample.sensors
    }


def _by_skill(
    recording: Recording,
    skill: Skill,
    platform: Platform,
    names: Collection[str],
    settings: Mapping[str, Scalar],
    rows: Sequence[dict[str, Label]],
) -> None:
    """Ask the labelling code what it reads from the recorded sensors."""
    with Labelling(
        skill.labelling_code, platform, rebinds=settings, line=skill.labelling_line
    ) as labelling:
        readable = {n for n in names if _is_reading(labelling, n)}
        start = labelling.start() if readable else None
        for sample, row in zip(recording.samples, rows, strict=True):
            for name in readable - row.keys():
                assert start is not None
                value = _read(labelling, start, name, sample)
                if value is not None:
                    row[name] = value


def _is_reading(labelling: Labelling, name: str) -> bool:
    function = labelling.functions.get(name)
    acts = name in labelling.acting
    return function is not None and function.readable and not function.parameters and not acts


class _UnknownError(VasoError):
    """A sensor that was not recorded."""


def _read(labelling: Labelling, start: Any, name: str, sample: Sample) -> Label | None:
    def ask(sensor: str, domain: Sequence[Scalar]) -> Scalar:
        if sensor not in sample.sensors:
            raise _UnknownError(sensor)
        return sample.sensors[sensor]

    try:
        outcome = labelling.request(start, name, (), {}, ask, 0.0)
    except _UnknownError:
        return None
    value = outcome.value if isinstance(outcome, Returned) else None
    return value if isinstance(value, bool | float) else None
