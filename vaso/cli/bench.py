"""``vaso bench``: measure on this machine."""

from __future__ import annotations

import dataclasses
import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from vaso.cli.bench_completion import completion
from vaso.cli.bench_exploring import exploring
from vaso.cli.bench_formulas import formulas
from vaso.cli.bench_shield import shield
from vaso.cli.benching import FOLDER, many, run_all
from vaso.cli.common import JsonOption, console
from vaso.cli.evidence import evidence, fuzz, mutation

if TYPE_CHECKING:
    from vaso.bench.verify import Row, Workload
    from vaso.cli.progress import Progress

app = typer.Typer(help="Measure on this machine; every number in the documentation is made here.")

app.command()(formulas)
app.command()(evidence)
app.command()(fuzz)
app.command()(mutation)
app.command()(exploring)
app.command()(many)
app.command()(shield)
app.command()(completion)


@app.callback(invoke_without_command=True)
def default(
    context: typer.Context,
    quick: Annotated[bool, typer.Option("--quick", help="Small workloads only.")] = False,
    out: Annotated[Path, typer.Option(help="Folder for tables, plots and data.")] = FOLDER,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Plans at a time; one a core by default.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Measure satisfiability, exploration, many plans, and how they grow, when none is named."""
    if context.invoked_subcommand is None:
        run_all(quick, out, workers, as_json)


@app.command()
def verify(
    repeats: Annotated[int, typer.Option(min=1, help="Counted runs of each engine.")] = 5,
    as_json: JsonOption = False,
) -> None:
    """Compare engines on the same plans: a NuSMV process per rule, per plan, PyNuSMV, lasso."""
    from vaso.bench.machine import describe_machine
    from vaso.bench.verify import measure, workloads
    from vaso.cli.progress import Progress

    out = console()
    if not as_json:
        out.print(f"Median of {repeats} runs on: {describe_machine()}")
    with Progress("exploring plans") as progress:
        for load in workloads():
            rows = measure(load, repeats, on_engine=partial(_tell, progress, load.name))
            with progress.aside():
                _print(out, load, rows, as_json)
            progress.update("exploring plans")


def _tell(progress: Progress, load: str, engine: str) -> None:
    progress.update(f"{load}: {engine}")


def _print(out: Console, load: Workload, rows: list[Row], as_json: bool) -> None:
    if as_json:
        for row in rows:
            print(json.dumps(dataclasses.asdict(row)), flush=True)
        return
    title = f"{load.name}: {rows[0].states} states, {rows[0].rules} rules"
    table = Table("engine", "all rules", "faster by", "verdicts", title=title, box=SIMPLE)
    for row in rows:
        table.add_row(row.engine, _seconds(row.seconds), _ratio(row.ratio), _tally(row.verdicts))
    out.print(table)
    out.print(f"exploring the plan took {_seconds(load.explore_seconds)}\n")


def _seconds(value: float | None) -> str:
    if value is None:
        return "does not apply"
    return f"{value * 1000:.1f} ms" if value < 1 else f"{value:.2f} s"


def _ratio(value: float | None) -> str:
    return "" if value is None else f"{value:.1f}×"


def _tally(verdicts: tuple[str, ...]) -> str:
    return ", ".join(f"{verdicts.count(v)} {v}" for v in dict.fromkeys(verdicts))
