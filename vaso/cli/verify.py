"""``vaso verify``: does every behaviour of a plan keep the rules of a skill?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vaso.cli.common import (
    ExitCode,
    JsonOption,
    NameOption,
    PlatformOption,
    SkillArgument,
    Version,
    VersionOption,
    code_of,
    console,
    emit,
    get_plan,
    get_skill,
    leave,
    write_text,
)
from vaso.verdict import VerificationResult

BRIEFLY, WATCHING = 2.0, 60.0
"""Seconds for finding out which lines run: by default, and where they are shown."""


def verify(
    skill: SkillArgument,
    plan: Annotated[
        str | None,
        typer.Option(help="A Python file with the plan; - for stdin; by default the template."),
    ] = None,
    spec: Annotated[
        list[str] | None, typer.Option(help="A further formula to check; may be repeated.")
    ] = None,
    version: VersionOption = Version.VERIFIED,
    name: NameOption = None,
    platform: PlatformOption = None,
    states: Annotated[int, typer.Option(min=1, help="Most states to explore.")] = 5_000,
    timeout: Annotated[float, typer.Option(min=0.0, help="Seconds for model checking.")] = 60.0,
    coverage: Annotated[
        bool, typer.Option("--coverage", help="Show which lines of the plan run, and the rest.")
    ] = False,
    html: Annotated[Path | None, typer.Option(help="Write an HTML report to a file.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Verify a plan: explore all its behaviours and model-check every rule.

    Exit code 0: every rule holds, 1: one is violated, 2: the plan is not a program of this skill,
    3: not known or not supported, or every rule holds for labels that are wrong about the robot.
    """
    from vaso.cli.progress import VerificationProgress
    from vaso.plan.explore import Budget
    from vaso.plan.model import Plan
    from vaso.verification import verify as check_rules

    chosen = get_skill(skill, version, name, platform)
    read = get_plan(plan) if plan else Plan(source=chosen.plan_template)
    budget = Budget(states=states)
    with VerificationProgress(budget, timeout) as progress:
        result = check_rules(
            chosen,
            read,
            platform=platform,
            specs=spec or (),
            budget=budget,
            timeout=timeout,
            coverage=WATCHING if coverage or html else BRIEFLY,
            on_progress=progress,
        )
    if html:
        from vaso.report.html import verification_html

        write_text(html, verification_html(result))
    if as_json:
        emit(result.to_json())
    else:
        console().print(result)
        if coverage and result.coverage:
            from vaso.report.coverage import coverage_view

            console().print(coverage_view(result.coverage, result.plan))
    leave(exit_code(result))


def exit_code(result: VerificationResult) -> ExitCode:
    """The exit code of a verification; 2 where the plan itself is wrong.

    A PASS over labels that are shown to be wrong about the robot is about some other robot: 3.
    """
    if result.problem is not None and result.problem.kind == "input":
        return ExitCode.BAD_INPUT
    if result and result.labels is not None and result.labels.agree is False:
        return ExitCode.UNKNOWN
    return code_of(result.verdict)
