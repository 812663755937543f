"""Views for the terminal: several plans together, and their behaviour side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from vaso.concurrency.gradient import JointBlame, joint_blames
from vaso.concurrency.result import CompositionResult, Doing, JointCounterexample
from vaso.report.terminal import plan_view, rule_text, summary, verdict_text
from vaso.report.trace import Row, seconds, short_call, trace_table
from vaso.verdict import SpecResult

STEPS = {
    "synchronous": "all step together",
    "interleaving": "one member steps at a time, in any order",
    "asynchronous": "any members step, one or several at a time",
}


def composition_view(result: CompositionResult, *, counterexamples: bool = True) -> Group:
    """A composition: who takes part, a table of rules, then what each violation looks like.

    Args:
        result: The result.
        counterexamples: Show the counterexample and the plans of each violated rule.
    """
    parts: list[RenderableType] = []
    if result.problem:
        parts.append(Text(result.problem.message, style="bold red"))
    if result.members:
        parts.append(members_line(result))
    if result.specs:
        parts.append(_rules(result.specs))
    parts.append(summary(result))
    parts += [Text(f"note: {w}", style="yellow") for w in result.warnings]
    if counterexamples:
        blames = joint_blames(result)
        parts += [
            violation_view(spec, result, blames.get(spec.spec))
            for spec in result.specs
            if isinstance(spec.counterexample, JointCounterexample)
        ]
    return Group(*parts)


def members_line(result: CompositionResult) -> Text:
    """One line: the members with the sizes of their plans, and how they step."""
    told = ", ".join(f"{m.name} ({m.states} states)" for m in result.members)
    period = f", every {result.dt:g} s" if result.dt is not None else ""
    return Text(f"{told}: {STEPS.get(result.mode, result.mode)}{period}", style="dim")


def _rules(specs: Sequence[SpecResult]) -> Table:
    """One row a rule: verdict, whose it is, the rule with its reading in English, time."""
    table = Table(box=box.SIMPLE_HEAD, expand=True, pad_edge=False)
    table.add_column("verdict", no_wrap=True)
    table.add_column("of", overflow="fold")
    table.add_column("rule", ratio=1, overflow="fold")
    table.add_column("time", justify="right", no_wrap=True)
    for spec in specs:
        whose = {"joint": "all", "exclusion": "all"}.get(spec.role, spec.role)
        table.add_row(verdict_text(spec.verdict), whose, rule_text(spec), seconds(spec.seconds))
    return table


def violation_view(
    spec: SpecResult, result: CompositionResult, blame: JointBlame | None = None
) -> Group:
    """A violated rule: the rule, what all members do, the plans with the lines marked."""
    example = spec.counterexample
    assert isinstance(example, JointCounterexample)
    parts: list[RenderableType] = [
        Text("\n✗ ", style="bold red").append(spec.spec, style="bold"),
        Text(f"The rule says: {spec.english}."),
        Text("Together the plans can do this instead:" if len(example.members) > 1
             else f"{example.members[0]} can do this instead:"),
        joint_counterexample_view(example),
    ]  # fmt: skip
    if blame and blame.text:
        parts += [Text(blame.text), ""]
    return Group(*parts, *_plans(example, result, blame))


def _plans(
    example: JointCounterexample, result: CompositionResult, blame: JointBlame | None
) -> Iterator[RenderableType]:
    """The plans of the members that take part, those to blame with their lines marked."""
    shown = [m for m in result.members if m.name in example.members]
    for member in shown:
        for name, text in member.plans.items():
            marks = blame.marks.get((member.name, name), ()) if blame else ()
            if text and (marks or not blame or not blame.marks):
                where = name if name == member.name else f"{member.name}, {name}"
                yield Text(f"plan of {where}:", style="bold")
                yield plan_view(text, dict.fromkeys(marks, ""))


def joint_counterexample_view(example: JointCounterexample) -> Table:
    """The steps of a counterexample: sensors, what each member does in which line, values."""
    trace = trace_table(example)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    table.add_column("step", justify="right")
    if example.timed:
        table.add_column("time", justify="right", no_wrap=True)
    for name in trace.sensors:
        table.add_column(_broken(name if name == "turn" else f"{name}?"), overflow="fold")
    for name in example.members:
        table.add_column(f"{name} does", overflow="fold")
        table.add_column("line", justify="right")
    for name in trace.values:
        table.add_column(_broken(name), overflow="fold")
    table.add_column("", overflow="fold")
    for row in trace.rows:
        cells, style = _cells(example, row, len(trace.sensors) + len(trace.values))
        table.add_row(*cells, style=style)
    return table


def _cells(example: JointCounterexample, row: Row, width: int) -> tuple[list[str], str]:
    timed = [row.time] if example.timed else []
    if row.skipped:
        blank = [""] * (width + 2 * len(example.members))
        return ["⋮", *[""] * len(timed), *blank, f"{row.skipped} more steps"], "dim"
    doing = example.doing[row.step]
    does = [cell for did in doing for cell in _does(did, first=row.step == 0)]
    step = f"↻ {row.steps}" if row.looping else row.steps
    notes = "; ".join(row.notes)
    style = "bold red" if row.violated else ""
    return [step, *timed, *row.sensed, *does, *row.values, notes], style


def _does(doing: Doing, *, first: bool) -> tuple[str, str]:
    """The call and its line; in brackets where the member has not moved."""
    call = short_call(doing.api or ("(at rest)" if doing.line is None else doing.command))
    line = "" if doing.line is None else str(doing.line)
    if doing.plan:
        line = f"{doing.plan} {line}".strip()
    return (call if doing.moved or first or call.startswith("(") else f"({call})"), line


def _broken(name: str) -> str:
    """A long name with line breaks behind its dots and underscores."""
    return name if len(name) <= 10 else name.replace(".", ".\n").replace("_", "_\n")
