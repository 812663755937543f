"""``vaso plan``: write a plan for a task."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vaso.cli.common import (
    JsonOption,
    NameOption,
    PlatformOption,
    SkillArgument,
    Version,
    VersionOption,
    emit,
    get_skill,
    write_text,
)

if TYPE_CHECKING:
    from vaso.plan.model import Plan
    from vaso.skill import Skill


def plan(
    skill: SkillArgument,
    task: Annotated[str, typer.Argument(help='What to do: "move forward 5 meters".')],
    version: VersionOption = Version.VERIFIED,
    name: NameOption = None,
    platform: PlatformOption = None,
    lm: Annotated[
        str | None,
        typer.Option(
            help="A language model, such as openai/gpt-4o-mini; without it the template "
            "is filled in with the quantities in the task."
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Write the plan to a file.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Write a plan for a task, guided by the skill's template."""
    from vaso.cli.progress import Progress

    chosen = get_skill(skill, version, name, platform)
    with Progress(f"asking {lm}" if lm else "filling in the template"):
        written = make_plan(chosen, task, lm)
    if out:
        write_text(out, written.source)
    if as_json:
        emit(
            {
                "skill": chosen.name,
                "task": task,
                "planner": lm or "symbolic",
                "plan": written.source,
            }
        )
    elif not out:
        print(written.source, end="" if written.source.endswith("\n") else "\n")


def make_plan(skill: Skill, task: str, lm: str | None) -> Plan:
    """A plan, by a language model if one is named.

    Raises:
        ModelError: The model cannot be reached.
    """
    from vaso.modules import SymbolicPlanner

    if lm is None:
        return SymbolicPlanner()(skill, task)
    from vaso.lm import get_lm, import_dspy
    from vaso.modules import Planner

    with import_dspy().context(lm=get_lm(lm)):
        found: Plan = Planner()(skill, task).plan
    return found
