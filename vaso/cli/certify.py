"""``vaso certify`` and ``vaso recheck``: verdicts that travel with the skill."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vaso.cli.common import (
    ExitCode,
    JsonOption,
    PlatformOption,
    SkillArgument,
    console,
    emit,
    leave,
)

TimeoutOption = Annotated[float, typer.Option(min=0.0, help="Seconds for model checking.")]


def certify(
    skill: SkillArgument,
    out: Annotated[Path | None, typer.Option(help="Write to another file.")] = None,
    platform: PlatformOption = None,
    timeout: TimeoutOption = 120.0,
    as_json: JsonOption = False,
) -> None:
    """Verify a skill's plan template and write a certificate into the skill file.

    Exit code 0: certified, 1: a rule is violated or labels are not true of the robot, 2: bad
    input, 3: not known or not supported.
    """
    from vaso.certificates import certify as make
    from vaso.certificates.certify import BUDGET
    from vaso.cli.progress import VerificationProgress
    from vaso.cli.verify import exit_code

    with VerificationProgress(BUDGET, timeout) as progress:
        found = make(skill, out=out, platform=platform, timeout=timeout, on_progress=progress)
    if as_json:
        emit(found.to_json())
    else:
        from vaso.report.certificates import certification_view

        console().print(certification_view(found))
    refused = found.result and not found
    leave(ExitCode.REFUTED if refused else exit_code(found.result))


def recheck(
    skill: SkillArgument,
    platform: PlatformOption = None,
    timeout: TimeoutOption = 120.0,
    as_json: JsonOption = False,
) -> None:
    """Verify a certified skill again, from scratch, and say what changed.

    Exit code 0: as certified and verified, 1: changed, or not verified, 2: bad input.
    """
    from vaso.certificates import recheck as again
    from vaso.certificates.certify import BUDGET
    from vaso.cli.progress import VerificationProgress

    with VerificationProgress(BUDGET, timeout) as progress:
        found = again(skill, platform=platform, timeout=timeout, on_progress=progress)
    if as_json:
        emit(found.to_json())
    else:
        console().print(found)
    leave(ExitCode.HOLDS if found else ExitCode.REFUTED)
