"""``vaso show``: a skill, or the automaton of a plan, in several formats."""

from __future__ import annotations

from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Group, RenderableType

from vaso.cli.common import (
    JsonOption,
    NameOption,
    PlatformOption,
    Version,
    VersionOption,
    console,
    get_plan,
    get_skill,
    warn_of_stale_certificate,
    write_text,
)
from vaso.errors import PlanError

if TYPE_CHECKING:
    from vaso.plan.model import Plan
    from vaso.plan.transition_system import TransitionSystem
    from vaso.skill import Skill


class Format(StrEnum):
    """Output formats."""

    TEXT = "text"
    DOT = "dot"
    SMV = "smv"
    HTML = "html"
    JSON = "json"


def show(
    target: Annotated[
        str, typer.Argument(metavar="SKILL|PLAN", help="A skill, or a .py file with a plan.")
    ],
    skill: Annotated[
        str | None, typer.Option(help="The skill that a plan belongs to, for its automaton.")
    ] = None,
    format_: Annotated[
        Format,
        typer.Option(
            "--format", help="dot and smv show the automaton; of a skill, its template's."
        ),
    ] = Format.TEXT,
    version: VersionOption = Version.VERIFIED,
    name: NameOption = None,
    platform: PlatformOption = None,
    out: Annotated[Path | None, typer.Option(help="Write to a file.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Show a skill, or what a plan can do."""
    chosen = Format.JSON if as_json else format_
    is_plan = target == "-" or target.endswith(".py")
    if is_plan and skill is None and chosen is not Format.TEXT:
        raise PlanError(
            f"the {chosen.value} of a plan shows its automaton, which needs its skill",
            hint=f"vaso show {target} --skill drive --format {chosen.value}",
        )
    owner = get_skill(skill or target, version, name, platform) if skill or not is_plan else None
    plan = get_plan(target) if is_plan else None
    if chosen is Format.TEXT and out is None:
        _print(owner, plan, platform)
    else:
        _put(_render(owner, plan, chosen, platform), out)


def _print(skill: Skill | None, plan: Plan | None, platform: str | None) -> None:
    from vaso.report.skill_view import skill_view, system_view
    from vaso.report.terminal import plan_view

    if plan is None:
        assert skill is not None
        console().print(skill_view(skill))
        warn_of_stale_certificate(skill)
        return
    parts: list[RenderableType] = [plan_view(plan.source)]
    if skill:
        parts.append(system_view(_system(skill, plan, platform)))
    console().print(Group(*parts))


def _render(skill: Skill | None, plan: Plan | None, chosen: Format, platform: str | None) -> str:
    """The text of a format that goes to a file or a pipe."""
    import json

    from vaso.plan.export import to_dot, to_json, to_smv
    from vaso.report.html import plan_html, skill_html
    from vaso.skill_file import write_skill

    if plan is None and skill and chosen in (Format.TEXT, Format.HTML, Format.JSON):
        whole = skill.model_dump(mode="json")
        return {
            Format.TEXT: lambda: write_skill(skill),
            Format.HTML: lambda: skill_html(skill),
            Format.JSON: lambda: json.dumps(whole, indent=2, ensure_ascii=False) + "\n",
        }[chosen]()
    if skill is None:
        assert plan is not None
        return plan.source
    system = _system(skill, plan, platform)
    rules = [r.formula for r in skill.rules]
    return {
        Format.TEXT: lambda: system.source,
        Format.HTML: lambda: plan_html(system),
        Format.DOT: lambda: to_dot(system),
        Format.SMV: lambda: str(to_smv(system, rules)),
        Format.JSON: lambda: json.dumps(to_json(system), indent=2) + "\n",
    }[chosen]()


def _system(skill: Skill, plan: Plan | None, platform: str | None) -> TransitionSystem:
    from vaso.cli.progress import VerificationProgress
    from vaso.plan.explore import Budget, compile_plan

    budget = Budget()
    with VerificationProgress(budget, timeout=0) as progress:
        return compile_plan(
            plan or skill.plan_template,
            skill,
            platform=platform,
            budget=budget,
            on_states=partial(progress, "exploring"),
        )


def _put(text: str, out: Path | None) -> None:
    if out:
        write_text(out, text)
    else:
        print(text, end="" if text.endswith("\n") else "\n")
