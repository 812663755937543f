"""``vaso bench`` as a whole, and ``vaso bench many``."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vaso.cli.common import JsonOption, console, emit, write_text
from vaso.cli.progress import Progress
from vaso.errors import MissingDependencyError

if TYPE_CHECKING:
    from vaso.bench.suite import Suite

FOLDER = Path("runs/bench")


def run_all(quick: bool, out: Path, workers: int | None, as_json: bool) -> None:
    """Measure everything, and write tables, plots and data into a folder."""
    from rich.markdown import Markdown

    from vaso.bench.suite import run
    from vaso.bench.tables import markdown

    with Progress("measuring") as progress:
        suite = run(quick=quick, workers=workers, on_step=lambda text: progress.update(text))
    told = markdown(suite)
    plots, missing = _draw(suite, out)
    page = told + "".join(f"\n![{path.stem}]({path.name})\n" for path in plots)
    write_text(out / "README.md", page)
    write_text(out / "results.json", json.dumps(suite.to_json(), indent=2, allow_nan=False) + "\n")
    if as_json:
        emit(suite.to_json())
        return
    console().print(Markdown(told))
    console().print(f"\nwritten to {out}" + missing, soft_wrap=True)


def _draw(suite: Suite, out: Path) -> tuple[list[Path], str]:
    from vaso.bench.plots import draw

    out.mkdir(parents=True, exist_ok=True)
    try:
        return draw(suite, out), ""
    except MissingDependencyError as error:
        return [], f", without plots: {error.message} ({error.hint})"


def many(
    plans: Annotated[int, typer.Option(min=1, help="How many plans.")] = 400,
    workers: Annotated[
        int | None, typer.Option(min=1, help="How many at a time; one a core by default.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Verify some hundred plans over the shipped skills: with nothing known, then from the memo."""
    from vaso.bench.machine import describe_machine
    from vaso.bench.many import measure

    with Progress("verifying plans") as progress:
        progress.update(total=plans)

        def tell(name: str, done: int) -> None:
            progress.update(f"{name}: {done} of {plans} plans", done=done)

        found = measure(plans, workers, tell)
    if as_json:
        emit({"machine": describe_machine(), "passes": [asdict(p) for p in found]})
        return
    out = console()
    out.print(f"{plans} plans, {found[0].rules} rules, on: {describe_machine()}")
    for result in found:
        verdicts = ", ".join(f"{n} {v}" for v, n in sorted(result.verdicts.items()))
        cpu = "" if result.cpu is None else f", {result.cpu:.1f} s of processor time"
        how = f"{result.workers} workers" if result.name == "cold" else f"{result.known} known"
        out.print(f"{result.name:5} {result.seconds:7.2f} s, {how}{cpu}   {verdicts}")
