"""Views for the terminal: a skill, and the automaton of a plan."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.syntax import Syntax
from rich.text import Text

from vaso.plan.transition_system import TransitionSystem
from vaso.report.automaton import Drawing, Node, condense
from vaso.report.html import english
from vaso.skill import Rule, Skill

MOST = 60


def skill_view(skill: Skill) -> Group:
    """A skill: what it is for, its rules with their reading in English, its code."""
    head = Text(skill.name, style="bold").append(f"   ({skill.platform})", style="dim not bold")
    parts: list[RenderableType] = [head, Text(" ".join(skill.description.split()))]
    for title, rules in (
        ("Global contract: kept by every skill of this robot", skill.global_rules),
        ("Local contract: what this skill is for", skill.local_rules),
        ("Assumptions about the surroundings", skill.assumptions),
    ):
        if rules:
            parts += ["", Text(title, style="bold"), *(_rule(r, skill) for r in rules)]
    for title, code in (
        ("Proposition-aligned APIs", skill.labelling_code),
        ("Plan template", skill.plan_template),
    ):
        parts += ["", Text(title, style="bold"), _code(code)]
    return Group(*parts)


def _rule(rule: Rule, skill: Skill) -> Padding:
    text = Text(rule.text).append(f"\n{english(rule, skill)}", style="dim")
    return Padding(text, (0, 0, 0, 2))


def _code(code: str) -> Padding:
    found = Syntax(code.rstrip("\n"), "python", theme="ansi_dark", background_color="default")
    return Padding(found, (0, 0, 0, 2))


def system_view(system: TransitionSystem) -> Group:
    """What a plan can do: its commands, and where each leads."""
    drawing = condense(system)
    kind = f"{len(system.states)} states, {system.transitions} transitions"
    parts = [Text(f"{kind}, one step every {system.dt:g} s", style="bold")]
    parts += [_node(drawing, number) for number in range(min(MOST, len(drawing.nodes)))]
    if len(drawing.nodes) > MOST:
        parts.append(Text(f"… and {len(drawing.nodes) - MOST} more", style="dim"))
    if system.cut:
        parts.append(Text(f"not explored further: {system.cut.reason}", style="yellow"))
    return Group(*parts)


def _node(drawing: Drawing, number: int) -> Text:
    node = drawing.nodes[number]
    text = Text(f"[{number}] {node.title}{_times(node, drawing.folded)}")
    if node.line:
        text.append(f"   line {node.line}", style="dim")
    for link in drawing.links:
        if link.source == number:
            target = drawing.nodes[link.target]
            when = link.label or target.entry
            text.append(f"\n      → [{link.target}] {target.title}")
            text.append(f" if {when}" if when else "", style="cyan")
    return text


def _times(node: Node, folded: bool) -> str:
    count = len(node.states)
    return "" if count == 1 else f" ({count} states)" if folded else f" × {count}"
