"""Check a recording against the rules of a skill, after the fact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from vaso.errors import VasoError
from vaso.ltl import propositions, variables
from vaso.monitoring.monitor import Truth
from vaso.monitoring.recorded.labels import labelled
from vaso.monitoring.recorded.reading import read_recording
from vaso.monitoring.recorded.recording import Recording
from vaso.monitoring.recorded.report import TraceReport
from vaso.monitoring.recorded.ros import RosOptions
from vaso.monitoring.watch import RuleStatus, Watch
from vaso.plan.transition_system import Label, Scalar
from vaso.platforms import Platform, get_platform
from vaso.skill import Skill
from vaso.verdict import Counterexample, Step

__all__ = ["check_log", "check_recording"]


def check_log(
    path: str | Path,
    skill: Skill | str,
    *,
    platform: str | Path | Platform | None = None,
    options: RosOptions | None = None,
    settings: Mapping[str, Scalar] | None = None,
) -> TraceReport:
    """Read a log and check it against the rules of a skill.

    Args:
        path: A log of ``vaso run``, messages of ROS topics, or telemetry of a PX4.
        skill: The skill, or the name or path of one.
        platform: The robot's platform; by default the skill's.
        options: How to read ROS messages.
        settings: Constants of the labelling code that the plan has set (``{"TARGET": "chair"}``).

    Raises:
        VasoError: The log cannot be read, or is from another platform.
        SkillError: There is no such skill.
        LabellingError: The labelling code does not run.
    """
    if isinstance(skill, str):
        from vaso.skill_file import load_skill

        skill = load_skill(skill)
    robot = get_platform(platform or skill.platform)
    recording = read_recording(path, robot, options)
    return check_recording(recording, skill, robot, settings=settings)


def check_recording(
    recording: Recording,
    skill: Skill,
    platform: Platform,
    *,
    settings: Mapping[str, Scalar] | None = None,
) -> TraceReport:
    """Check a recording against the rules of a skill.

    Raises:
        VasoError: It is from another platform, or has no states.
        LabellingError: The labelling code does not run.
    """
    if recording.platform and recording.platform != platform.name:
        raise VasoError(
            f"the log is from the platform {recording.platform}, the skill is for {platform.name}",
            source=recording.source,
        )
    if not recording.samples:
        raise VasoError("the log has no states", source=recording.source)
    rules = (*skill.rules, *skill.assumptions)
    names = {n for r in rules for n in (*propositions(r.formula), *variables(r.formula))}
    rows = labelled(recording, skill, platform, names, settings or {})
    watch = Watch.of(skill, platform)
    for row in rows:
        watch.observe(row)
    examples = {
        status.rule: _example(status, recording, rows)
        for status in watch.statuses
        if status.truth is Truth.VIOLATED
    }
    return TraceReport(recording, skill, platform, watch.statuses, examples)


def _example(
    status: RuleStatus, recording: Recording, rows: Sequence[Mapping[str, Label]]
) -> Counterexample:
    """The recorded states up to the one in which the rule was lost."""
    last = status.step or 0
    formula = status.rule.formula
    needed = propositions(formula) | variables(formula)
    samples = recording.samples[: last + 1]
    common = set.intersection(*(set(row) for row in rows[: last + 1]))
    sensors = set.intersection(*(set(s.sensors.keys()) for s in samples))
    return Counterexample(
        formula=str(formula),
        steps=tuple(
            Step(
                index=index,
                state=index,
                command=sample.command or "(not recorded)",
                api=sample.api,
                line=sample.line,
                sensors={name: sample.sensors[name] for name in sorted(sensors)},
                labels={n: v for n, v in sorted(row.items()) if n in common | needed},
                note=sample.note,
            )
            for index, (sample, row) in enumerate(zip(samples, rows, strict=False))
        ),
        loop_start=last,
        decided_at=last,
        dt=recording.dt,
        recorded=True,
    )
