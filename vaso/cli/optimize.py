"""``vaso optimize``: improve a skill until the plans that it leads to are verified."""

from __future__ import annotations

from pathlib import Path
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
    write_text,
)
from vaso.cli.optimizing import (
    CostOption,
    LmCallsOption,
    LmOption,
    LossCallsOption,
    PlannerLmOption,
    PlannerOption,
    SecondsOption,
    StepsOption,
    TokensOption,
    known_optimizers,
    make_budget,
    make_planner,
)
from vaso.gradient.model import Level

if TYPE_CHECKING:
    from vaso.optimizers import OptimizationResult

REPORT = "report.html"


def optimize(
    skill: SkillArgument,
    tasks: Annotated[
        str | None,
        typer.Option(help="A .yaml file of tasks, or one task; by default the skill's seen tasks."),
    ] = None,
    optimizer: Annotated[
        str, typer.Option(help=f"{known_optimizers()}.", show_default=True)
    ] = "repair",
    lm: LmOption = None,
    planner: PlannerOption = None,
    planner_lm: PlannerLmOption = None,
    level: Annotated[
        Level, typer.Option(help="How much a textual gradient says; each includes those before it.")
    ] = Level.BLAME,
    out: Annotated[
        Path | None, typer.Option(help="Folder for the skill, the event log and the report.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the run in --out.")] = False,
    seed: Annotated[int, typer.Option(help="Seed of everything random.")] = 0,
    candidates: Annotated[
        int | None,
        typer.Option(min=1, help="Candidates that loop asks for and judges at the same time."),
    ] = None,
    field: Annotated[
        list[Path] | None,
        typer.Option(help="A log of the robot; what it violates counts. May be repeated."),
    ] = None,
    steps: StepsOption = 10,
    loss_calls: LossCallsOption = None,
    lm_calls: LmCallsOption = None,
    tokens: TokensOption = None,
    cost: CostOption = None,
    seconds: SecondsOption = None,
    version: VersionOption = Version.INITIAL,
    name: NameOption = None,
    platform: PlatformOption = None,
    as_json: JsonOption = False,
) -> None:
    """Optimize a skill against the model checker.

    --steps and the options after it limit what may be spent; without a value there is no limit.

    Exit code 0: the skill is verified on every task, 1: it is not, 3: a model did not answer. The
    best version is kept.
    """
    from vaso.cli.progress import OptimizationProgress
    from vaso.optimizers import optimize as run

    chosen = get_skill(skill, version, name, platform)
    with OptimizationProgress(steps, seconds) as progress:
        result = run(
            chosen,
            tasks,
            optimizer=optimizer,
            lm=lm,
            planner=make_planner(planner, planner_lm),
            planner_lm=planner_lm,
            level=level,
            out=out,
            resume=resume,
            budget=make_budget(steps, loss_calls, lm_calls, tokens, cost, seconds),
            candidates=candidates,
            field=field or (),
            seed=seed,
            on_event=progress,
        )
    report = _write_report(result, out)
    if as_json:
        emit(result.to_json())
    else:
        _show(result, out, report)
    leave(_exit_code(result))


def _exit_code(result: OptimizationResult) -> ExitCode:
    from vaso.optimizers.shared import INTERRUPTED

    if result.verified:
        return ExitCode.HOLDS
    if result.stop_reason == INTERRUPTED:
        return ExitCode.INTERRUPTED
    return ExitCode.UNKNOWN if result.error else ExitCode.REFUTED


def _write_report(result: OptimizationResult, out: Path | None) -> Path | None:
    if out is None:
        return None
    from vaso.report.html import optimization_html

    write_text(out / REPORT, optimization_html(result))
    return out / REPORT


def _show(result: OptimizationResult, out: Path | None, report: Path | None) -> None:
    terminal = console()
    terminal.print(result)
    if out:
        terminal.print(f"\nskill: {out / 'SKILL.md'}\nreport: {report}")
    else:
        terminal.print("\nwith --out DIR the skill, the event log and a report are written")
