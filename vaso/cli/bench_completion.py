"""``vaso bench completion``: do the shipped skills complete their tasks, and safely?"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from vaso.cli.common import ExitCode, JsonOption, console, emit, leave, write_text
from vaso.cli.progress import Progress

LEAST = 0.95
"""The part of the runs of a verified template that must complete its task."""


def completion(
    seeds: Annotated[int, typer.Option(min=1, help="Runs of each task.")] = 20,
    skill: Annotated[
        list[str] | None, typer.Option(help="Only this shipped skill; may be repeated.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes; one a core by default.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Write the tables, also one of all tasks, to a Markdown file."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Simulate all tasks: templates before and after optimization, and a plan that does nothing.

    Exit code 0: the verified templates complete at least 95 % of the runs of each skill and keep
    every rule, and doing nothing completes no run; 1 otherwise.
    """
    from rich.markdown import Markdown

    from vaso.bench.completion import SKILLS, by_skill, by_task, measure
    from vaso.bench.machine import describe_machine

    with Progress("simulating tasks") as progress:
        tallies = measure(
            seeds,
            skills=skill or SKILLS,
            workers=workers,
            on_done=lambda done, total: progress.update(done=done, total=total),
        )
    if out:
        write_text(out, f"{by_skill(tallies)}\n{by_task(tallies)}")
    if as_json:
        emit({"machine": describe_machine(), "tallies": [asdict(t) for t in tallies]})
    else:
        console().print(f"{seeds} seeds of each task, on: {describe_machine()}")
        console().print(Markdown(by_skill(tallies)))
    verified = [t for t in tallies if t.version == "verified"]
    ok = all(t.safe == t.runs for t in verified) and not any(
        t.complete for t in tallies if t.version == "still"
    )
    for name in dict.fromkeys(t.skill for t in verified):
        runs = sum(t.runs for t in verified if t.skill == name)
        ok = ok and sum(t.complete for t in verified if t.skill == name) >= LEAST * runs
    leave(ExitCode.HOLDS if ok else ExitCode.REFUTED)
