"""``vaso compare``: optimizers side by side on the same skill."""

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
    from vaso.comparison import Comparison

PLOTS = (".svg", ".png", ".pdf")


def compare(
    skill: SkillArgument,
    optimizers: Annotated[
        str | None,
        typer.Option(
            help=f"Names with commas: {known_optimizers()}. By default all that are "
            "installed, without a model repair alone."
        ),
    ] = None,
    lm: LmOption = None,
    planner: PlannerOption = None,
    planner_lm: PlannerLmOption = None,
    seeds: Annotated[int, typer.Option(min=1, help="Runs of each optimizer.")] = 1,
    tasks: Annotated[
        str | None,
        typer.Option(
            help="A .yaml file of seen and unseen tasks, or one task; by default the skill's file."
        ),
    ] = None,
    unseen: Annotated[
        bool, typer.Option(help="Test the skills at the end on the unseen tasks.")
    ] = True,
    level: Annotated[
        Level, typer.Option(help="How much a textual gradient says; each includes those before it.")
    ] = Level.BLAME,
    steps: StepsOption = 10,
    loss_calls: LossCallsOption = None,
    lm_calls: LmCallsOption = None,
    tokens: TokensOption = None,
    cost: CostOption = None,
    seconds: SecondsOption = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for table, plot, report, and a folder a run.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with --out; finished runs are not made again.")
    ] = False,
    workers: Annotated[
        int, typer.Option(min=1, help="Runs at a time; more than 1 makes times incomparable.")
    ] = 1,
    csv: Annotated[Path | None, typer.Option(help="Write a line for each run.")] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw safety over loss calls: .svg, .png or .pdf.")
    ] = None,
    version: VersionOption = Version.INITIAL,
    name: NameOption = None,
    platform: PlatformOption = None,
    as_json: JsonOption = False,
) -> None:
    """Compare optimizers on the same skill, tasks and budget, over several seeds.

    The budget, --steps and the options after it, is that of each run.

    verified: runs at whose end every rule passes on every task.
    safety: share of the rules that the plans keep; unseen safety: on tasks held out.
    completion: how much of what the first plans could do is left.
    loss calls: verifications of a candidate on a task.
    Numbers are means over the runs of an optimizer, ± their standard deviation.

    Exit code 0: every run is verified, 1: some are not, 3: some failed.
    """
    from vaso.cli.comparing import ComparisonProgress
    from vaso.comparison import compare as run

    _check_plot(plot)
    chosen = get_skill(skill, version, name, platform)
    with ComparisonProgress(steps) as progress:
        found = run(
            chosen,
            optimizers=optimizers,
            lm=lm,
            seeds=seeds,
            tasks=tasks,
            unseen=unseen,
            budget=make_budget(steps, loss_calls, lm_calls, tokens, cost, seconds),
            level=level,
            planner=make_planner(planner, planner_lm),
            planner_lm=planner_lm,
            out=out,
            resume=resume,
            workers=workers,
            on_event=progress,
        )
    if as_json:
        emit(found.to_json())
    else:
        _show(found, out)
    if csv:
        write_text(csv, found.to_csv())
    if plot:
        _draw(found, plot)
    leave(_code(found))


def _check_plot(path: Path | None) -> None:
    """Find out before the runs what cannot be drawn after them.

    Raises:
        VasoError: The ending is none of a plot.
        MissingDependencyError: matplotlib is needed and not installed.
    """
    from vaso.comparison.figure import require_matplotlib
    from vaso.errors import VasoError

    if path is None or path.suffix == ".svg":
        return
    if path.suffix not in PLOTS:
        raise VasoError(
            "this is no plot", source=str(path), expected=f"a file that ends in {', '.join(PLOTS)}"
        )
    require_matplotlib()


def _draw(found: Comparison, path: Path) -> None:
    from vaso.errors import VasoError

    if path.suffix == ".svg":
        write_text(path, found.svg())
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        found.plot().savefig(path)
    except OSError as error:
        raise VasoError(f"the file cannot be written: {error}", source=str(path)) from error


def _show(found: Comparison, out: Path | None) -> None:
    terminal = console()
    terminal.print(found)
    if out:
        terminal.print(f"\nreport: {out / 'report.html'}", soft_wrap=True)


def _code(found: Comparison) -> ExitCode:
    if found.interrupted:
        return ExitCode.INTERRUPTED
    if any(row.error for row in found.rows):
        return ExitCode.UNKNOWN
    return ExitCode.HOLDS if found else ExitCode.REFUTED
