"""``vaso bench formulas``: the satisfiability families of the literature."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from vaso.cli.common import JsonOption, console

if TYPE_CHECKING:
    from vaso.bench.corpus import Result, Row


def formulas(
    limit: Annotated[float, typer.Option(min=0.1, help="Seconds for each formula.")] = 10.0,
    quick: Annotated[bool, typer.Option("--quick", help="Small sizes only.")] = False,
    family: Annotated[str, typer.Option(help="Only families whose name contains this text.")] = "",
    plain_every: Annotated[
        int,
        typer.Option(min=0, help="Ask plain NuSMV about every so manieth formula; 0 for never."),
    ] = 5,
    as_json: JsonOption = False,
) -> None:
    """Decide the families of formulas that the literature compares satisfiability checkers on."""
    from vaso.bench.corpus import corpus, decide_all, small, summary
    from vaso.bench.machine import describe_machine
    from vaso.cli.progress import Progress

    cases = [c for c in (small() if quick else corpus()) if family in c.family]
    results: list[Result] = []
    with Progress("deciding formulas") as progress:
        for result in decide_all(cases, limit=limit, plain_every=plain_every):
            results.append(result)
            progress.update(f"deciding formulas: {result.family}", done=len(results))
            progress.update(total=len(cases))
            if as_json:
                with progress.aside():
                    print(json.dumps(dataclasses.asdict(result)), flush=True)
    if not as_json and results:
        console().print(f"{limit:g} s for each formula on: {describe_machine()}")
        print(_table(summary(results)))


def _table(rows: Sequence[Row]) -> str:
    """The families as a Markdown table."""
    lines = [
        "| family | formulas | sat | unsat | not decided | wrong | median CPU | longest CPU "
        "| plain NuSMV decides | its median |",
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for r in rows:
        asked = f"{r.plain} of {r.plain_asked}" if r.plain_asked else "not asked"
        cells = [r.family, r.formulas, r.sat, r.unsat, r.formulas - r.sat - r.unsat, r.wrong]
        cells += [_time(r.median), _time(r.slowest), asked, _time(r.plain_median)]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def _time(seconds: float | None) -> str:
    if seconds is None:
        return ""
    return f"{seconds * 1000:.0f} ms" if seconds < 1 else f"{seconds:.1f} s"
