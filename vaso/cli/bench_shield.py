"""``vaso bench shield``: what the run-time shield costs in each control period."""

from __future__ import annotations

from typing import Annotated

import typer

from vaso.cli.common import JsonOption, console, emit


def shield(
    steps: Annotated[int, typer.Option(min=100, help="Steps for each skill.")] = 2_000,
    seed: Annotated[int, typer.Option(help="Seed of commands and readings.")] = 0,
    as_json: JsonOption = False,
) -> None:
    """Measure the time that the shield takes for a step, on random commands and readings."""
    from rich.box import SIMPLE
    from rich.table import Table

    from vaso.bench.machine import describe_machine
    from vaso.bench.shield import measure

    rows = measure(steps, seed)
    if as_json:
        emit([row.to_json() for row in rows])
        return
    out = console()
    out.print(f"Milliseconds a step, {steps} random steps a skill, on: {describe_machine()}")
    table = Table("skill", "rules", "blocked", "CPU", "median", "99 %", "worst", box=SIMPLE)
    table.columns[0].no_wrap = True
    table.columns[0].min_width = 24
    for row in rows:
        times = (f"{t:.2f}" for t in (row.processor, row.median, row.high, row.worst))
        table.add_row(row.skill, str(row.rules), f"{row.replaced:.0%}", *times)
    out.print(table)
