"""What the commands share: exit codes, options, output, and finding a skill."""

from __future__ import annotations

import json
import sys
from enum import IntEnum, StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from vaso.cli.plain import PlainConsole
from vaso.verdict import Verdict

if TYPE_CHECKING:
    from vaso.plan.model import Plan
    from vaso.skill import Skill


class ExitCode(IntEnum):
    """What a command's exit code says."""

    HOLDS = 0
    REFUTED = 1
    BAD_INPUT = 2
    UNKNOWN = 3
    INTERNAL = 70
    INTERRUPTED = 130


class Version(StrEnum):
    """Which version of a skill folder."""

    INITIAL = "initial"
    VERIFIED = "verified"


SkillArgument = Annotated[
    str,
    typer.Argument(help="A shipped skill (see `vaso skills`), a SKILL.md file, or its folder."),
]
VersionOption = Annotated[
    Version, typer.Option(help="Which version of a skill folder: `initial` is the faulty one.")
]
NameOption = Annotated[
    str | None, typer.Option("--name", help="The skill to take from a file that holds several.")
]
PlatformOption = Annotated[
    str | None,
    typer.Option("--platform", help="jackal, px4, or a .py file; by default the skill says."),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")]


def console(*, stderr: bool = False) -> Console:
    """A console; as wide as the terminal, 80 columns and without colour where there is none."""
    file = sys.stderr if stderr else sys.stdout
    width = None if file.isatty() else 80
    return PlainConsole(file=file, width=width, highlight=False)


def emit(data: Any) -> None:
    """Print JSON."""
    print(json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False), flush=True)


def get_skill(skill: str, version: Version, name: str | None, platform: str | None = None) -> Skill:
    """Load the skill that the user named.

    Raises:
        SkillError: There is none, or its file cannot be read.
    """
    from vaso.skill_file import load_skill

    return load_skill(skill, version=version.value, name=name, platform=platform)


def get_plan(path: str, task: str | None = None) -> Plan:
    """Read a plan from a file, or from standard input for ``-``.

    Raises:
        PlanError: It cannot be read.
    """
    from vaso.plan.model import Plan

    if path == "-":
        text = sys.stdin.buffer.read().decode("utf-8", errors="replace")
        return Plan(source=text, task=task, path="<stdin>")
    return Plan.read(path, task=task)


def write_text(path: Path, text: str) -> None:
    """Write a file that the user asked for.

    Raises:
        VasoError: It cannot be written.
    """
    from vaso.errors import VasoError

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise VasoError(f"the file cannot be written: {error}", source=str(path)) from error


def warn_of_stale_certificate(skill: Skill) -> None:
    """Say in one line that a skill carries a certificate which is not about its file any more."""
    from vaso.certificates import stale

    why = stale(skill)
    if why:
        hint = "vaso recheck verifies again"
        console().print(f"note: its certificate does not fit: {why} ({hint})", style="yellow")


def code_of(verdict: Verdict) -> ExitCode:
    """The exit code of a verdict."""
    known = {Verdict.PASS: ExitCode.HOLDS, Verdict.FAIL: ExitCode.REFUTED}
    return known.get(verdict, ExitCode.UNKNOWN)


def leave(code: ExitCode) -> None:
    """End the command with an exit code."""
    raise typer.Exit(int(code))
