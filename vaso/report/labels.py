"""Views on label validation: one line in a verification, a table of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from vaso.labels.result import LabelComparison, LabelReport, LabelStatus
from vaso.report.markup import Markup, el, join
from vaso.report.page import cell

if TYPE_CHECKING:
    from vaso.verdict import VerificationResult

HEADS = {
    True: ("✓ LABELS AGREE", "bold green"),
    False: ("✗ LABELS DIFFER", "bold red"),
    None: ("? LABELS NOT VALIDATED", "bold yellow"),
}
MARKS = {
    LabelStatus.PROVED: ("✓ proved equal", "green"),
    LabelStatus.SAMPLED: ("✓ no difference", "green"),
    LabelStatus.DIFFERS: ("✗ differs", "bold red"),
    LabelStatus.INCOMPARABLE: ("? not compared", "yellow"),
}
STYLES = {True: "dim", False: "bold red", None: "yellow"}
BADGES = {True: "pass", False: "fail", None: ""}


def label_lines(result: VerificationResult) -> list[RenderableType]:
    """What a verification says about the labels that its verdicts are about."""
    if not result.states:
        return []
    agree = result.labels.agree if result.labels is not None else None
    said = ""
    if agree is False:
        said = f"✗ {'this PASS is' if result else 'these verdicts are'} not about the robot: "
    return [Text(f"{said}{result.label_line}", style=STYLES[agree])]


def labels_view(report: LabelReport) -> Group:
    """A label validation: the outcome, a row for each proposition, what a plan shows."""
    head = Text(*HEADS[report.agree])
    head.append(f"   {report.skill}" if report.skill else "", style="default not bold")
    parts: list[RenderableType] = [head, Text(report.line, style=STYLES[report.agree])]
    if report.comparisons:
        parts.append(labels_table(report))
    if report.in_plan is not None:
        parts.append(Text(f"plan template: {report.in_plan.line}", STYLES[report.in_plan.agree]))
    return Group(*parts)


def labels_table(report: LabelReport) -> Table:
    """One row a proposition: outcome, proposition, what was found and how."""
    table = Table(box=box.SIMPLE_HEAD, expand=True, pad_edge=False)
    table.add_column("label", no_wrap=True)
    table.add_column("proposition", overflow="fold")
    table.add_column("compared with the robot", ratio=1, overflow="fold")
    for comparison in report.comparisons:
        table.add_row(Text(*MARKS[comparison.status]), _name(comparison), _found(comparison))
    return table


def _name(comparison: LabelComparison) -> Text:
    return Text(comparison.name, style="" if comparison.mentioned else "dim")


def _found(comparison: LabelComparison) -> str:
    """What was found, without the outcome that stands beside it."""
    bare = comparison.status in (LabelStatus.PROVED, LabelStatus.INCOMPARABLE)
    return comparison.detail if bare else comparison.text


def label_banner(result: VerificationResult) -> Markup:
    """What a verification says about its labels, for a page."""
    lines = label_lines(result)
    if not lines:
        return Markup()
    agree = result.labels.agree if result.labels is not None else None
    kind = {True: "soft", False: "banner fail", None: "banner"}[agree]
    return el("p", str(lines[0]), cls=kind)


def labels_cell(report: LabelReport) -> str:
    """A label validation as HTML."""
    word = el("span", HEADS[report.agree][0], cls=f"badge {BADGES[report.agree]}".strip())
    rows = [_row(c) for c in report.comparisons]
    plan = el("p", f"plan template: {report.in_plan.line}") if report.in_plan is not None else None
    card = el("div", rows, cls="card rules") if rows else None
    return cell(
        el("div", word, el("span", report.skill), cls="facts"), el("p", report.line), card, plan
    )


def _row(comparison: LabelComparison) -> Markup:
    kinds = {LabelStatus.DIFFERS: "fail", LabelStatus.INCOMPARABLE: ""}
    kind = kinds.get(comparison.status, "pass")
    badge = el("span", MARKS[comparison.status][0], cls=f"badge {kind}".strip())
    text = join(el("p", el("code", comparison.name)), el("p", _found(comparison), cls="soft"))
    return el("div", el("div", badge), el("div", text), cls="rule")
