"""How a checked recording is shown in a terminal."""

from __future__ import annotations

import io

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from vaso.gradient import blames
from vaso.ltl import to_english
from vaso.monitoring.monitor import Truth
from vaso.monitoring.recorded.report import TraceReport, told
from vaso.monitoring.watch import RuleStatus
from vaso.report.terminal import violation_view

__all__ = ["trace_html", "trace_view"]

WIDTH = 110
"""Columns of the HTML page."""


def trace_view(report: TraceReport) -> Group:
    """The rules, then for each violated one what was recorded and what is to blame."""
    parts: list[RenderableType] = [_head(report)]
    parts += [_rule(status, report) for status in report.statuses]
    result = report.result()
    found = {spec.formula: blame for spec, blame in blames(result, report.skill)}
    for spec in result.specs:
        if spec.counterexample is not None:
            parts.append(violation_view(spec, result.plan, found.get(spec.formula)))
    return Group(*parts)


def trace_html(report: TraceReport) -> str:
    """The same as an HTML page."""
    console = Console(record=True, width=WIDTH, file=io.StringIO(), highlight=False)
    console.print(trace_view(report))
    return console.export_html()


def _head(report: TraceReport) -> Text:
    recording = report.recording
    if report.violated:
        count, total = len(report.violated), len(report.rules)
        head = Text(f"✗ {count} of {total} rules violated", style="bold red")
    elif report.undecided:
        head = Text("? NOT ALL RULES DECIDED", style="bold yellow")
    else:
        head = Text("✓ NO RULE VIOLATED", style="bold green")
    seconds = recording.samples[-1].time
    about = (
        f"   {recording.kind}, {len(recording.samples)} states of {recording.dt:g} s, {seconds:g} s"
    )
    if recording.skill not in ("", report.skill.name):
        about += f", a run of {recording.skill}"
    return head.append(about, style="dim not bold")


def _rule(status: RuleStatus, report: TraceReport) -> Group:
    mark, style = _mark(status)
    rule = Text(f"  {mark} ", style=style).append(status.rule.text, style="default")
    if status.rule.role == "assumption":
        rule.append("   (assumed)", style="dim")
    english = to_english(status.rule.formula, report.platform.phrases)
    known = told(status, len(report.recording.samples))
    below = [Text(english, style="dim"), Text(known, style=style)]
    return Group(rule, *(Padding(text, (0, 0, 0, 4)) for text in below))


def _mark(status: RuleStatus) -> tuple[str, str]:
    if status.truth is Truth.VIOLATED:
        return "✗", "bold red"
    if status.problem or (status.truth is Truth.OPEN and status.unknown):
        return "?", "yellow"
    if status.waits:
        return "…", "yellow"
    return "✓", "green"
