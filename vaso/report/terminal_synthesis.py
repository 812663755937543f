"""Views for the terminal: whether a contract can be kept whatever the sensors show."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich import box
from rich.console import Group, RenderableType
from rich.syntax import Syntax
from rich.table import Table
from rich.text import Text

from vaso.report.labels import label_lines

if TYPE_CHECKING:
    from vaso.synthesis.counterplay import CounterPlay
    from vaso.synthesis.result import Realizability

SHOWN_COMMANDS = 4
HEADS = {
    True: ("✓ REALIZABLE", "bold green"),
    False: ("✗ NOT REALIZABLE", "bold red"),
    None: ("? NOT DECIDED", "bold yellow"),
}
ORIGINS = {
    "synthesized": "This plan was made without a language model, and verified:",
    "template": "The skill's plan template is verified, so there is a plan.",
}


def realizability_view(result: Realizability) -> Group:
    """The answer with its evidence: a verified plan, or the sensors that defeat every plan."""
    head = Text(*HEADS[result.realizable]).append(f"   {result.skill}", style="default not bold")
    parts: list[RenderableType] = [head]
    parts += [Text(f"assuming: {a}", style="yellow") for a in result.assumptions]
    parts += [Text(f"why: {result.reason}", style="yellow")] if result.reason else []
    parts += outside_views(result)
    if result.origin:
        parts.append(Text(ORIGINS[result.origin]))
    if result.plan and result.origin == "synthesized":
        parts += ["", Syntax(result.plan, "python", theme="ansi_light", background_color="default")]
    if result.verification is not None and not result.verification.labels:
        parts += label_lines(result.verification)
    return Group(*parts, *defeat_views(result))


def outside_views(result: Realizability) -> list[RenderableType]:
    """The rules that the game could not represent as they are."""
    return [Text(f"outside GR(1): {o.rule}: {o.reason}", style="yellow") for o in result.outside]


def defeat_views(result: Realizability) -> list[RenderableType]:
    """Why no plan keeps the rules, and what can be done about it; nothing where one does."""
    if result.realizable is not False:
        return []
    several = len(result.core) > 1
    said = "No plan can keep these rules together" if several else "No plan can keep this rule"
    parts: list[RenderableType] = [Text(f"{said}:", style="bold red")]
    parts += [Text(f"  {rule.text}") for rule in result.core]
    if not result.minimal:
        parts.append(Text("why: a smaller part may do, but time ran out", style="yellow"))
    if result.counterplay:
        parts += counterplay_views(result.counterplay)
    if result.refinement:
        parts.append(Text("A plan can keep this rule instead of the local one:", style="bold"))
        parts.append(Text(f"  {result.refinement.after}", style="green"))
    if result.remedies:
        what = "assumption" if len(result.remedies) == 1 else "one of the assumptions"
        lead = "Or, where the world is like that, declare the" if result.refinement else (
            "Where the world is like that, declare the")  # fmt: skip
        parts.append(Text(f"{lead} {what}:".replace("the one", "one"), style="bold"))
        parts += [Text(f"  {text}", style="green") for text in result.remedies]
    return parts


def counterplay_views(play: CounterPlay) -> list[RenderableType]:
    """The behaviour of the sensors, and what it leaves the robot to do."""
    if play.fixed:
        lead = "The sensors defeat every plan by showing this, whatever the robot does:"
    else:
        lead = "The sensors defeat every plan by answering what the robot does. For instance:"
    return [Text(lead), counterplay_table(play), Text(ending(play))]


def counterplay_table(play: CounterPlay) -> Table:
    """One row a step: sensors, what the robot can still do, which rules forbid the rest."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    table.add_column("step", justify="right", no_wrap=True)
    names = [n for n in play.steps[0].observed if not _is_constant(play, n)]
    for name in names:
        table.add_column(f"{name.removesuffix('_observed')}?", overflow="fold")
    table.add_column("the robot can do", overflow="fold", max_width=26)
    table.add_column("the rest is forbidden by", overflow="fold", ratio=1)
    for i, step in enumerate(play.steps):
        mark = "↻ " if i == play.loop_start else ""
        seen = [_value(step.observed[n]) for n in names]
        table.add_row(f"{mark}{i}", *seen, _commands(step.possible), "\n".join(step.forbidden_by))
        for command, observed in _answers(play, i):
            told = [_value(observed[n]) for n in names]
            table.add_row(
                "", *(Text(t, style="dim") for t in told), Text(f"after {command}", "dim")
            )
    return table


def ending(play: CounterPlay) -> str:
    """What becomes of the rules."""
    if play.loop_start is None:
        if len(play.steps) == 1:
            return "Already in step 0, with the robot at rest, a rule is broken."
        if play.steps and not play.steps[-1].possible:
            return f"In step {len(play.steps) - 1} everything that the robot can do breaks a rule."
        return "And so on."
    start, last = play.loop_start, len(play.steps) - 1
    repeated = f"Step {last} repeats" if start == last else f"Steps {start} to {last} repeat"
    if not play.waiting:
        return f"{repeated} for ever."
    if len(play.waiting) == 1:
        return f"{repeated} for ever, and {play.waiting[0]} is never kept."
    return f"{repeated} for ever, and not all of {', '.join(play.waiting)} can be kept."


def _is_constant(play: CounterPlay, name: str) -> bool:
    """Whether an observation is off all the time, so that it does not matter."""
    shown = [s.observed[name] for s in play.steps]
    shown += [o[name] for s in play.steps for _, o in s.answers]
    return all(value is False for value in shown) and len(play.steps[0].observed) > 1


def _answers(play: CounterPlay, index: int) -> list[tuple[str, dict[str, object]]]:
    """The other answers of the sensors, the first command for each."""
    step = play.steps[index]
    first: dict[tuple[object, ...], tuple[str, dict[str, object]]] = {}
    for command, observed in step.answers:
        if observed != step.observed:
            first.setdefault(tuple(observed.values()), (command, dict(observed)))
    return list(first.values())


def _value(value: object) -> str:
    return {True: "yes", False: "no"}[value] if isinstance(value, bool) else str(value)


def _commands(names: tuple[str, ...]) -> str:
    if not names:
        return "nothing"
    if len(names) <= SHOWN_COMMANDS:
        return ", ".join(names)
    return f"{', '.join(names[: SHOWN_COMMANDS - 1])}, … ({len(names)} in all)"
