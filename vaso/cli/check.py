"""``vaso check``: can the rules of a skill be kept at all, and are its labels true of the robot?"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from vaso.cli.common import (
    ExitCode,
    JsonOption,
    NameOption,
    PlatformOption,
    SkillArgument,
    Version,
    VersionOption,
    console,
    emit,
    get_skill,
    leave,
    warn_of_stale_certificate,
)

if TYPE_CHECKING:
    from vaso.feasibility import FeasibilityResult
    from vaso.labels import LabelReport
    from vaso.skill import Skill

CODES = {True: ExitCode.HOLDS, False: ExitCode.REFUTED, None: ExitCode.UNKNOWN}


def check(
    skill: SkillArgument,
    version: VersionOption = Version.VERIFIED,
    name: NameOption = None,
    platform: PlatformOption = None,
    timeout: Annotated[float, typer.Option(min=0.0, help="Seconds for the whole check.")] = 10.0,
    labels: Annotated[
        bool,
        typer.Option("--labels", help="Compare the labelling code with the robot thoroughly."),
    ] = False,
    seed: Annotated[int, typer.Option(help="Seed of the random runs that compare labels.")] = 0,
    as_json: JsonOption = False,
) -> None:
    """Check that the rules of a skill can be kept, and that its labels are true of the robot.

    Exit code 0: the rules can be kept, and no label is wrong; 1: they cannot (with the rules in
    conflict), or a label of theirs is wrong (with a witness); 3: not decided.
    """
    from vaso.cli.progress import Progress
    from vaso.feasibility import check as feasible

    chosen = get_skill(skill, version, name, platform)
    with Progress(f"checking {len(chosen.rules)} rules", limit=timeout) as progress:
        result = feasible(chosen, timeout=timeout)
        progress.update("comparing labels with the robot")
        report = _labels(chosen, thorough=labels, seed=seed)
    if as_json:
        emit({**result.to_json(), "labels": report.to_json()})
    else:
        from vaso.report.terminal_runs import feasibility_view

        console().print(feasibility_view(result))
        console().print(report if labels or report.agree is False else report.line)
        warn_of_stale_certificate(chosen)
    leave(_code(result, report, thorough=labels))


def _labels(skill: Skill, *, thorough: bool, seed: int) -> LabelReport:
    from vaso.labels import FULL, QUICK, validate_labels

    return validate_labels(skill, effort=FULL if thorough else QUICK, seed=seed)


def _code(result: FeasibilityResult, report: LabelReport, *, thorough: bool) -> ExitCode:
    """The exit code; labels that could not be compared count only where that was asked for."""
    if result.hopeless or report.agree is False:
        return ExitCode.REFUTED
    if thorough and report.agree is None:
        return ExitCode.UNKNOWN
    return CODES[result.feasible]
