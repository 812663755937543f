"""Views for the terminal: what was verified, what is wrong, what was changed.

Each function returns a rich renderable that fits 80 columns and needs neither colour nor any
knowledge of temporal logic to be understood.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from rich import box
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from vaso.report.between import between_views
from vaso.report.coverage import coverage_notes
from vaso.report.labels import label_lines
from vaso.report.trace import Row, blame_of, marks_of, seconds, trace_table
from vaso.verdict import Counterexample, SpecResult, Verdict, VerificationResult

if TYPE_CHECKING:
    from vaso.gradient.blame import Blame
    from vaso.optimizers.result import OptimizationResult

STYLES = {
    Verdict.PASS: ("✓ PASS", "bold green"),
    Verdict.FAIL: ("✗ FAIL", "bold red"),
    Verdict.UNKNOWN: ("? UNKNOWN", "bold yellow"),
    Verdict.UNSUPPORTED: ("– UNSUPPORTED", "bold yellow"),
}
WIDEST_CALL, WIDEST_NAME = 26, 12
DIFF = {"+": "green", "-": "red", "@": "cyan"}


def verdict_text(verdict: Verdict) -> Text:
    """A verdict as a coloured word with its symbol."""
    return Text(*STYLES[verdict])


def verification_view(result: VerificationResult, *, counterexamples: bool = True) -> Group:
    """A verification result: a table of rules, then what each violation looks like.

    Args:
        result: The result.
        counterexamples: Show the counterexample and the plan lines of each violated rule.
    """
    parts: list[RenderableType] = []
    if result.problem:
        parts += [Text(result.problem.message, style="bold red"), *_where(result)]
    if result.specs:
        parts.append(rules_table(result))
    parts += between_views(result.between)
    parts.append(summary(result))
    parts += label_lines(result)
    parts += [Text(f"note: {w}", style="yellow") for w in result.warnings]
    parts += coverage_notes(result.coverage)
    if counterexamples:
        parts += violation_views(result)
    return Group(*parts)


def summary(result: VerificationResult) -> Text:
    """One line: verdict, rules kept, size of the automaton, time."""
    kept = sum(bool(s.verdict) for s in result.specs)
    bad = result.problem is not None and result.problem.kind == "input"
    text = Text("✗ CANNOT BE VERIFIED", "bold red") if bad else verdict_text(result.verdict)
    if result.specs:
        text.append(f"   {kept} of {len(result.specs)} rules hold", style="default not bold")
    size = f"   {result.states} states, {result.transitions} transitions" if result.states else ""
    known = "   from memo" if result.from_memo else ""
    return text.append(f"{size}   {seconds(result.seconds)}{known}", style="dim not bold")


def rules_table(result: VerificationResult) -> Table:
    """One row a rule: verdict, the rule with its reading in English, time."""
    table = Table(box=box.SIMPLE_HEAD, expand=True, pad_edge=False)
    table.add_column("verdict", no_wrap=True)
    table.add_column("rule", ratio=1, overflow="fold")
    table.add_column("time", justify="right", no_wrap=True)
    for spec in result.specs:
        table.add_row(verdict_text(spec.verdict), rule_text(spec), seconds(spec.seconds))
    return table


def rule_text(spec: SpecResult) -> Text:
    """A rule, its English reading, and what to know about its verdict."""
    text = Text(spec.spec)
    if spec.english:
        text.append(f"\n{spec.english}", style="dim")
    for label, remark in remarks(spec):
        text.append(f"\n{label}: {remark}", style="yellow")
    return text


def remarks(spec: SpecResult) -> Iterator[tuple[str, str]]:
    """What to know about a verdict: a label and a text each."""
    for assumption in spec.assumptions:
        yield "assuming", assumption
    if spec.vacuous:
        yield "vacuous", spec.vacuous
    if spec.stronger:
        yield "holds even", _in_english(spec.stronger)
    if spec.unchecked:
        yield "not checked", f"whether the rule says anything about this plan ({spec.unchecked})"
    if spec.reason:
        yield "why", spec.reason
    for warning in spec.warnings:
        yield "note", warning


def _in_english(formula: str) -> str:
    from vaso.ltl import parse, to_english

    return to_english(parse(formula))


def violation_views(result: VerificationResult) -> list[RenderableType]:
    """For each violated rule, a behaviour of the plan that violates it, and the lines to blame."""
    blames = blame_of(result)
    return [
        violation_view(spec, result.plan, blames.get(spec.formula))
        for spec in result.specs
        if spec.counterexample
    ]


_CAN_DO = "The plan can do this instead:"


def violation_view(spec: SpecResult, plan: str, blame: Blame | None = None) -> Group:
    """A violated rule: the rule, the behaviour that violates it, the plan with the lines marked."""
    assert spec.counterexample is not None
    parts: list[RenderableType] = [
        Text("\n✗ ", style="bold red").append(spec.spec, style="bold"),
        Text(f"The rule says: {spec.english}."),
        Text("The robot did this:" if spec.counterexample.recorded else _CAN_DO),
        counterexample_view(spec.counterexample),
    ]
    if blame and blame.text:
        parts += [Text(blame.text), ""]
    if plan:
        parts.append(plan_view(plan, marks_of(blame)))
    return Group(*parts)


def counterexample_view(example: Counterexample) -> Table:
    """The steps of a counterexample: sensors, what the robot does, plan line, values."""
    trace = trace_table(example)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    table.add_column("step", justify="right")
    table.add_column("time", justify="right", no_wrap=True)
    for name in trace.sensors:
        table.add_column(f"{name}?", overflow="fold")
    widest = max(len("the robot does"), *(len(row.does) for row in trace.rows))
    # A fixed width: rich crops a table whose columns have a least width instead of folding it.
    table.add_column("the robot does", overflow="fold", width=min(widest, WIDEST_CALL))
    table.add_column("line", justify="right")
    for name in trace.values:
        table.add_column(_broken(name), overflow="fold")
    table.add_column("", overflow="fold")
    width = len(trace.sensors) + len(trace.values)
    for row in trace.rows:
        cells, style = _cells(row, width)
        table.add_row(*cells, style=style)
    return table


def _broken(name: str) -> str:
    """A long name with line breaks where its words end."""
    return name if len(name) <= WIDEST_NAME else name.replace("_", "_\n")


def _cells(row: Row, width: int) -> tuple[list[str], str]:
    if row.skipped:
        blank = [""] * (width + 2)
        return ["⋮", "", *blank, f"{row.skipped} more steps"], "dim"
    style = "bold red" if row.violated else ""
    notes = "; ".join(row.notes)
    step = f"↻ {row.steps}" if row.looping else row.steps
    return [step, row.time, *row.sensed, row.does, row.line, *row.values, notes], style


def plan_view(plan: str, marks: Mapping[int, str] | None = None) -> Padding:
    """A plan with line numbers; marked lines carry an arrow, and why if there is more to say."""
    marks = marks or {}
    text = Text(no_wrap=False)
    for number, line in enumerate(plan.rstrip("\n").split("\n"), start=1):
        marked = number in marks
        text.append(
            f"{'→' if marked else ' '}{number:>3} │ ", style="bold red" if marked else "dim"
        )
        text.append(line, style="bold" if marked else "")
        text.append(f"   ← {marks[number]}" if marks.get(number) else "", style="red")
        text.append("\n")
    text.rstrip()
    return Padding(text, (0, 0, 0, 1))


def _where(result: VerificationResult) -> list[RenderableType]:
    problem = result.problem
    if problem is None or problem.line is None or not result.plan:
        return []
    return [plan_view(result.plan, {problem.line: "here"})]


def diff_view(before: str, after: str, name: str = "", *, context: int = 2) -> Text:
    """A unified diff, coloured; empty when nothing changed."""
    text = Text()
    lines = difflib.unified_diff(
        before.splitlines(), after.splitlines(), n=context, lineterm="", fromfile=name, tofile=name
    )
    for line in list(lines)[2:]:
        text.append(f"{line}\n", style=DIFF.get(line[0], ""))
    text.rstrip()
    return text


def optimization_view(result: OptimizationResult) -> Group:
    """An optimization: where it ended, its steps, and what changed in the skill."""
    from vaso.report import terminal_runs

    return terminal_runs.optimization_view(result)
