"""``vaso verify``: does every behaviour of a plan keep the rules of a skill?"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

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
from vaso.errors import PlanError
from vaso.verdict import VerificationResult

if TYPE_CHECKING:
    from vaso.skill import Skill

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
    plans: Annotated[
        str | None,
        typer.Option(help="A folder of plans (*.py), or a pattern in quotes: many at a time."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="With --plans: how many at a time; one a core.")
    ] = None,
    no_memo: Annotated[
        bool, typer.Option("--no-memo", help="Verify again what is known from before.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Verify a plan: explore all its behaviours and model-check every rule.

    Exit code 0: every rule holds, 1: one is violated, 2: the plan is not a program of this skill,
    3: not known or not supported, or every rule holds for labels that are wrong about the robot.
    With --plans: 1 if any plan is refuted, else 2 or 3 if that is so of any, else 0.
    """
    chosen = get_skill(skill, version, name, platform)
    options: dict[str, Any] = {"platform": platform, "specs": spec or ()}
    if plans is not None:
        _refuse_both(plan, html, coverage)
        _verify_all(chosen, plans, workers, no_memo, states, timeout, as_json, options)
    watching = WATCHING if coverage or html else BRIEFLY
    result = _verify_one(chosen, plan, no_memo, states, timeout, {**options, "coverage": watching})
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


def _verify_one(
    skill: Skill,
    plan: str | None,
    no_memo: bool,
    states: int,
    timeout: float,
    options: dict[str, Any],
) -> VerificationResult:
    from vaso.cli.progress import VerificationProgress
    from vaso.memo import default_memo, verify_remembered
    from vaso.plan.explore import Budget
    from vaso.plan.model import Plan

    read = get_plan(plan) if plan else Plan(source=skill.plan_template)
    budget = Budget(states=states)
    with VerificationProgress(budget, timeout) as progress:
        return verify_remembered(
            skill,
            read,
            memo=None if no_memo else default_memo(),
            with_system=True,
            timeout=timeout,
            on_progress=progress,
            budget=budget,
            **options,
        )


def _refuse_both(plan: str | None, html: Path | None, coverage: bool) -> None:
    """What only a single plan has.

    Raises:
        PlanError: An option for a single plan was given.
    """
    given = {"--plan": plan is not None, "--html": html is not None, "--coverage": coverage}
    for option in (name for name, is_given in given.items() if is_given):
        raise PlanError(f"{option} is for a single plan, and --plans for many")


def _verify_all(
    skill: Skill,
    plans: str,
    workers: int | None,
    no_memo: bool,
    states: int,
    timeout: float,
    as_json: bool,
    options: dict[str, Any],
) -> None:
    import time

    from vaso.cli import verify_many as many
    from vaso.parallel import verify_many
    from vaso.plan.explore import Budget

    paths, started = many.find_plans(plans), time.monotonic()
    budget = Budget(states=states)
    batch = verify_many(
        paths,
        skill,
        workers=workers,
        timeout=budget.seconds + 2 * timeout,
        memo=not no_memo,
        budget=budget,
        **options,
    )
    results = many.follow(batch)
    seconds = time.monotonic() - started
    if as_json:
        many.as_data(skill.name, paths, results, seconds)
    else:
        many.show(paths, results, seconds)
    leave(many.worst(map(exit_code, results)))


def exit_code(result: VerificationResult) -> ExitCode:
    """The exit code of a verification; 2 where the plan itself is wrong.

    A PASS over labels that are shown to be wrong about the robot is about some other robot: 3.
    """
    if result.problem is not None and result.problem.kind == "input":
        return ExitCode.BAD_INPUT
    if result.is_mislabelled:
        return ExitCode.UNKNOWN
    return code_of(result.verdict)
