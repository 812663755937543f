"""``vaso synthesize``: a plan that keeps the rules of a skill, made without a language model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vaso.cli.check import CODES
from vaso.cli.common import (
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
from vaso.cli.verify import exit_code


def synthesize(
    skill: SkillArgument,
    version: VersionOption = Version.VERIFIED,
    name: NameOption = None,
    platform: PlatformOption = None,
    write: Annotated[Path | None, typer.Option(help="Write the plan to a file.")] = None,
    timeout: Annotated[float, typer.Option(min=0.0, help="Seconds for everything.")] = 10.0,
    as_json: JsonOption = False,
) -> None:
    """Write a plan that keeps every rule whatever the sensors show, or show why there is none.

    Exit code 0: there is a verified plan, 1: no plan can keep the rules, 3: not known, or the plan
    keeps them for labels that are wrong about the robot.
    """
    from vaso.cli.progress import Progress
    from vaso.synthesis import realizability

    chosen = get_skill(skill, version, name, platform)
    with Progress(f"playing {len(chosen.rules)} rules against the sensors", limit=timeout):
        result = realizability(chosen, timeout=timeout)
    if as_json:
        emit(result.to_json())
    else:
        from vaso.report.terminal_synthesis import realizability_view

        console().print(realizability_view(result))
    if write is not None and result.plan is not None:
        write_text(write, result.plan)
    checked = result.verification
    leave(CODES[result.realizable] if checked is None else exit_code(checked))
