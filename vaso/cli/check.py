"""``vaso check``: can the rules of a skill be kept at all?"""

from __future__ import annotations

from typing import Annotated

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
    warn_of_stale_certificate,
)

CODES = {True: ExitCode.HOLDS, False: ExitCode.REFUTED, None: ExitCode.UNKNOWN}


def check(
    skill: SkillArgument,
    version: VersionOption = Version.VERIFIED,
    name: NameOption = None,
    platform: PlatformOption = None,
    timeout: Annotated[float, typer.Option(min=0.0, help="Seconds for the whole check.")] = 10.0,
    as_json: JsonOption = False,
) -> None:
    """Check that the rules of a skill can be kept, before any plan is written.

    Exit code 0: feasible, 1: infeasible (with the rules in conflict), 3: not decided.
    """
    from vaso.cli.progress import Progress
    from vaso.feasibility import check as feasible

    chosen = get_skill(skill, version, name, platform)
    with Progress(f"checking {len(chosen.rules)} rules", limit=timeout):
        result = feasible(chosen, timeout=timeout)
    if as_json:
        emit(result.to_json())
    else:
        from vaso.report.terminal_runs import feasibility_view

        console().print(feasibility_view(result))
        warn_of_stale_certificate(chosen)
    leave(CODES[result.feasible])
