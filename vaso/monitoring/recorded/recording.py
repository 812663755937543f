"""A recording: what a robot did and what was true, one sample for each control period."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from vaso.errors import VasoError
from vaso.plan.transition_system import Label, Scalar
from vaso.platforms import Issued

__all__ = ["Recording", "Sample", "sample_count"]

MAX_SAMPLES = 1_000_000
"""More than a day at 10 Hz."""


@dataclass(frozen=True, slots=True)
class Sample:
    """One state of a recording.

    Attributes:
        time: Seconds since the first sample.
        command: The low-level command in force, as text; empty where it was not recorded.
        issued: The same as a command of the platform, where it is one.
        api: The plan's call that issued it, where that was recorded.
        line: The plan line of that call.
        sensors: Raw sensor readings; those that are not in it are not known.
        labels: Propositions that the recording itself gives a value to.
        measured: Measured values of numeric propositions.
        note: Remark.
    """

    time: float
    command: str = ""
    issued: Issued | None = None
    api: str = ""
    line: int | None = None
    sensors: Mapping[str, Scalar] = field(default_factory=dict)
    labels: Mapping[str, Label] = field(default_factory=dict)
    measured: Mapping[str, float] = field(default_factory=dict)
    note: str = ""


@dataclass(frozen=True)
class Recording:
    """A recording at the control period of a platform.

    Attributes:
        source: The file.
        kind: What it is, in words: ``run log``, ``ROS messages``, ``MAVLink telemetry``.
        dt: Seconds between two samples.
        samples: The states; the first is before the first command.
        skill: The skill that was run, where that was recorded.
        platform: Name of the platform, where that was recorded.
        plan: Text of the plan, where that was recorded.
        task: The plan's task prompt, where that was recorded.
    """

    source: str
    kind: str
    dt: float
    samples: tuple[Sample, ...]
    skill: str = ""
    platform: str = ""
    plan: str = ""
    task: str = ""


def sample_count(seconds: float, dt: float, source: str) -> int:
    """The number of samples of a recording, the one at its start included.

    Raises:
        VasoError: It is too long; most likely its times are not all of one clock.
    """
    if seconds / dt > MAX_SAMPLES:
        raise VasoError(
            f"the log spans {seconds:.3g} s",
            source=source,
            expected=f"at most {MAX_SAMPLES * dt:g} s",
            hint="are all its times of the same clock, and in seconds?",
        )
    return 1 + max(0, math.ceil(round(seconds / dt, 6)))
