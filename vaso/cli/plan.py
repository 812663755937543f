"""``vaso plan``: write a plan for a task."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
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
    console,
    emit,
    get_skill,
    write_text,
)

if TYPE_CHECKING:
    from vaso.modules.symbolic import Filling
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
    place: Annotated[
        list[str] | None,
        typer.Option(help="How far ahead a place is, in metres: `doorway=4`. Repeatable."),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Write the plan to a file.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Write a plan for a task, guided by the skill's template.

    What of the task could not be used is said on standard error.
    """
    from vaso.cli.progress import Progress

    chosen = get_skill(skill, version, name, platform)
    places = read_places(place or [])
    with Progress(f"asking {lm}" if lm else "filling in the template"):
        filling = make_filling(chosen, task, lm, places)
    written = filling.plan
    if out:
        write_text(out, written.source)
    if as_json:
        emit(
            {
                "skill": chosen.name,
                "task": task,
                "planner": lm or "symbolic",
                "plan": written.source,
                "filled": dict(filling.filled),
                "kept": dict(filling.kept),
                "unused": list(filling.unused),
            }
        )
    elif not out:
        print(written.source, end="" if written.source.endswith("\n") else "\n")
    say_what_is_missing(filling)


def say_what_is_missing(filling: Filling) -> None:
    """Say on standard error what of a task did not go into its plan."""
    told = [f'"{part}"' for part in filling.unused]
    if told:
        _note(f"not used of the task: {', '.join(told)}")
    if filling.kept:
        kept = ", ".join(f"{name} = {value!r}" for name, value in filling.kept.items())
        _note(f"the task does not say, so the template's own value is kept: {kept}")


def _note(text: str) -> None:
    console(stderr=True).print(f"note: {text}", style="yellow", markup=False, soft_wrap=True)


def read_places(texts: Sequence[str]) -> dict[str, float]:
    """Read options such as ``doorway=4``.

    Raises:
        VasoError: One is not a name, an equals sign, and a distance in metres.
    """
    from vaso.errors import VasoError

    places = {}
    for text in texts:
        name, _, metres = text.rpartition("=")
        try:
            places[" ".join(name.split())] = distance = float(metres)
        except ValueError:
            distance = -1.0
        if not name.strip() or not 0 <= distance < math.inf:
            raise VasoError(f"'{text}' is no place", expected="a name and metres: doorway=4")
    return places


def make_filling(
    skill: Skill, task: str, lm: str | None, places: Mapping[str, float] | None = None
) -> Filling:
    """A plan, by a language model if one is named, and what went into it where none is.

    Raises:
        ModelError: The model cannot be reached.
    """
    from vaso.modules.symbolic import Filling, SymbolicPlanner

    if lm is None:
        return SymbolicPlanner(places=places).fill(skill, task)
    from vaso.lm import get_lm, import_dspy
    from vaso.modules import Planner

    with import_dspy().context(lm=get_lm(lm)):
        return Filling(Planner()(skill, task).plan)
