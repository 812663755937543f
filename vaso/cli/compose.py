"""``vaso compose``: do several plans together keep their rules?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vaso.cli.common import JsonOption, console, emit, leave, write_text
from vaso.cli.verify import exit_code
from vaso.errors import VasoError

if TYPE_CHECKING:
    from vaso.concurrency import CompositionResult


def compose(
    members: Annotated[
        list[str],
        typer.Argument(
            metavar="MEMBER…",
            help="NAME=SKILL, or NAME=SKILL:PLAN.py; or one mission file (.yaml).",
        ),
    ],
    rule: Annotated[
        list[str] | None,
        typer.Option(help='A rule over all, such as "G !(a.forward & b.forward)"; repeatable.'),
    ] = None,
    mode: Annotated[
        str | None,
        typer.Option(help="synchronous (the default), interleaving or asynchronous."),
    ] = None,
    share: Annotated[
        list[str] | None,
        typer.Option(help="An observation that is the same for all, or NAME=a.x,b.y."),
    ] = None,
    link: Annotated[
        list[str] | None,
        typer.Option(help="a.OBSERVATION=b.PROPOSITION: what a observes is what b does."),
    ] = None,
    exclude: Annotated[
        list[str] | None,
        typer.Option(help="Propositions of which no two may hold at a time: forward, or a.x,b.y."),
    ] = None,
    unfair: Annotated[
        bool, typer.Option("--unfair", help="Do not assume that everyone moves again and again.")
    ] = False,
    only_joint: Annotated[
        bool, typer.Option("--only-joint", help="Do not check the members' own rules.")
    ] = False,
    states: Annotated[int, typer.Option(min=1, help="Most joint states.")] = 200_000,
    timeout: Annotated[float, typer.Option(min=0.0, help="Seconds for model checking.")] = 60.0,
    html: Annotated[Path | None, typer.Option(help="Write an HTML report to a file.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Verify several plans that run at the same time.

    Propositions are written MEMBER.PROPOSITION. Exit code 0: every rule holds, 1: one is violated,
    2: bad input, 3: not known or not supported, or every rule holds for labels that are wrong about
    a robot.
    """
    from dataclasses import replace

    from vaso.concurrency.composing import JOINT_BUDGET

    mission = _mission(members)
    given: dict[str, Any] = {
        "rules": [*_listed(mission.options.get("rules")), *(rule or [])],
        "joint_budget": replace(JOINT_BUDGET, states=states),
        "timeout": timeout,
    }
    given |= {"mode": mode} if mode else {}
    given |= {"share": _shared(share)} if share else {}
    given |= {"links": dict(_pair(text, "--link") for text in link)} if link else {}
    given |= {"exclude": [_group(text) for text in exclude]} if exclude else {}
    given |= {"fair": False} if unfair else {}
    given |= {"own": False} if only_joint else {}
    result = mission.compose(**given)
    if not result.specs and result.problem is None:
        raise VasoError("there is no rule to check", hint='give one with --rule "G !(…)"')
    _show(result, html, as_json)


def _mission(members: Sequence[str]) -> Any:
    from vaso.concurrency import Member, Mission, load_mission

    if len(members) == 1 and Path(members[0]).suffix in (".yaml", ".yml"):
        return load_mission(members[0])
    found: dict[str, Any] = {}
    for text in members:
        name, equals, rest = text.partition("=")
        skill, plan = _split(rest if equals else text)
        member = Member(skill, Path(plan) if plan else None, name=name if equals else None)
        if member.name in found:
            raise VasoError(
                f"two members are called '{member.name}'", hint=f"name them: left={skill}"
            )
        found[member.name] = member
    return Mission(found)


def _split(text: str) -> tuple[str, str]:
    """``drive:plan.py`` as skill and plan."""
    skill, _, plan = text.rpartition(":")
    return (skill, plan) if skill else (text, "")


def _listed(rules: object) -> list[str]:
    if rules is None:
        return []
    return [rules] if isinstance(rules, str) else list(rules)  # type: ignore[call-overload]


def _shared(texts: Sequence[str]) -> list[str] | Mapping[str, list[str]]:
    """``people_observed`` as it is; ``person=a.people_observed,b.person_seen`` as a mapping."""
    if not any("=" in text for text in texts):
        return list(texts)
    pairs = [_pair(text, "--share") for text in texts]
    return {name: group.split(",") for name, group in pairs}


def _pair(text: str, option: str) -> tuple[str, str]:
    left, equals, right = text.partition("=")
    if not equals or not left.strip() or not right.strip():
        raise VasoError(f"{option} {text} has no '='", expected="LEFT=RIGHT in each of them")
    return left.strip(), right.strip()


def _group(text: str) -> str | list[str]:
    return [part.strip() for part in text.split(",")] if "," in text else text.strip()


def _show(result: CompositionResult, html: Path | None, as_json: bool) -> None:
    if html:
        from vaso.report.composition_html import composition_html

        write_text(html, composition_html(result))
    if as_json:
        emit(result.to_json())
    else:
        console().print(result)
    leave(exit_code(result))
