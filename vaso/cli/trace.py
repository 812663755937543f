"""``vaso trace``: did a robot keep the rules of a skill in a recorded run?"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from vaso.cli.common import (
    JsonOption,
    NameOption,
    PlatformOption,
    Version,
    VersionOption,
    code_of,
    console,
    emit,
    get_skill,
    leave,
    write_text,
)
from vaso.errors import VasoError
from vaso.gradient.model import Level
from vaso.plan.transition_system import Scalar


def trace(
    log: Annotated[
        Path,
        typer.Argument(
            help="A log of `vaso run`, messages of ROS topics, or telemetry of a PX4 "
            "(JSON lines, a JSON array, or CSV)."
        ),
    ],
    skill: Annotated[
        str, typer.Option("--skill", help="A shipped skill, a SKILL.md file, or its folder.")
    ],
    version: VersionOption = Version.VERIFIED,
    name: NameOption = None,
    platform: PlatformOption = None,
    setting: Annotated[
        list[str] | None,
        typer.Option("--set", help="A constant that the plan has set: TARGET=chair."),
    ] = None,
    velocity_topic: Annotated[
        str, typer.Option(help="ROS: the topic with the commands, where several carry velocities.")
    ] = "",
    detections_topic: Annotated[
        list[str] | None,
        typer.Option(
            help="ROS: the topic of a detector, where that is not clear; may be repeated."
        ),
    ] = None,
    confidence: Annotated[
        float, typer.Option(min=0.0, max=1.0, help="ROS: least score of a detection that counts.")
    ] = 0.5,
    age: Annotated[
        float, typer.Option(min=0.0, help="ROS: seconds after which a detector counts as silent.")
    ] = 0.5,
    gradient: Annotated[
        Level | None, typer.Option(help="Print the textual gradient at a level, and nothing else.")
    ] = None,
    html: Annotated[Path | None, typer.Option(help="Write a report to a file.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Check a recorded log against the rules of a skill.

    Exit code 0: no rule is violated, and nothing is awaited; 1: a rule is violated, with the step;
    2: the log cannot be read; 3: some rule is not decided by the log.
    """
    from vaso.monitoring.recorded import RosOptions, check_log

    report = check_log(
        log,
        get_skill(skill, version, name, platform),
        platform=platform,
        options=RosOptions(velocity_topic, tuple(detections_topic or ()), confidence, age),
        settings=_settings(setting or ()),
    )
    if html is not None:
        from vaso.report.recorded import trace_html

        write_text(html, trace_html(report))
    if gradient is not None:
        found = report.gradient(gradient)
        print("no rule is violated" if found is None else str(found))
    elif as_json:
        emit(report.to_json())
    else:
        console().print(report)
    leave(code_of(report.verdict))


def _settings(texts: Sequence[str]) -> dict[str, Scalar]:
    """Constants as ``NAME=VALUE``; a value that is no Python constant is a text.

    Raises:
        VasoError: One is written otherwise.
    """
    found: dict[str, Scalar] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip().isidentifier():
            raise VasoError(f"--set {text} sets nothing", expected="NAME=VALUE")
        found[name.strip()] = _constant(value.strip())
    return found


def _constant(text: str) -> Scalar:
    try:
        value = ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return text
    return value if isinstance(value, bool | int | float | str) else text
