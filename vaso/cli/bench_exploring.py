"""``vaso bench exploring``: how many transitions a second exploration takes."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from vaso.cli.common import JsonOption, console, emit
from vaso.cli.progress import Progress


def exploring(
    repeats: Annotated[int, typer.Option(min=1, help="Runs of each plan.")] = 5,
    as_json: JsonOption = False,
) -> None:
    """Explore the shipped templates and a plan of each style of the corpus, on one core."""
    from rich.box import SIMPLE
    from rich.table import Table

    from vaso.bench.exploring import measure, together
    from vaso.bench.machine import describe_machine

    rates = []
    with Progress("exploring plans") as progress:
        for rate in measure(repeats):
            rates.append(rate)
            progress.update(f"exploring plans: {rate.plan}")
    total = together(rates)
    if as_json:
        found = [{**asdict(r), "per_second": r.per_second} for r in [*rates, total]]
        emit({"machine": describe_machine(), "plans": found})
        return
    out = console()
    out.print(f"Median of {repeats} runs, on: {describe_machine()}")
    table = Table("plan", "states", "transitions", "ms", "transitions/s", box=SIMPLE)
    for column in table.columns[1:]:
        column.justify = "right"
    table.columns[0].no_wrap = True
    for rate in [*rates, total]:
        numbers = f"{rate.states:,}", f"{rate.transitions:,}", f"{1e3 * rate.seconds:,.0f}"
        table.add_row(rate.plan, *numbers, f"{rate.per_second:,.0f}", end_section=rate is rates[-1])
    out.print(table)
