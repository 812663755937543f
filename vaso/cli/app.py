"""The command line as a typer application: one file a command."""

from __future__ import annotations

from typing import Annotated

import typer

from vaso import __version__
from vaso.cli import (
    bench,
    cache,
    certify,
    check,
    compare,
    compose,
    demo,
    optimize,
    plan,
    robot,
    run_plan,
    sat,
    show,
    simulate,
    skills,
    synthesize,
    trace,
    verify,
)

app = typer.Typer(
    name="vaso",
    help="Robot skills that are checked before they move: contracts in temporal logic, plans "
    "model-checked, counterexamples turned into better skills.",
    epilog="Exit codes: 0 holds · 1 refuted · 2 bad input · 3 unknown or unsupported.",
    no_args_is_help=True,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"vaso {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Print a traceback on errors.")] = False,
) -> None:
    """Options of every command."""


for command in (
    check.check,
    verify.verify,
    compose.compose,
    sat.sat,
    plan.plan,
    simulate.simulate,
    run_plan.run,
    trace.trace,
    synthesize.synthesize,
    certify.certify,
    certify.recheck,
    optimize.optimize,
    compare.compare,
    show.show,
    skills.skills,
    demo.demo,
):
    app.command()(command)
app.add_typer(bench.app, name="bench")
app.add_typer(cache.app, name="cache")
app.add_typer(robot.app, name="robot")
