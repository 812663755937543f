"""Views for the terminal: several plans together, and their behaviour side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rich import box
from rich.console import Console, ConsoleOptions, Group, JustifyMethod, RenderableType, RenderResult
from rich.table import Table
from rich.text import Text

from vaso.concurrency.gradient import JointBlame, joint_blames
from vaso.concurrency.result import CompositionResult, Doing, JointCounterexample
from vaso.concurrency.schedule import TURN
from vaso.report.labels import label_lines
from vaso.report.terminal import plan_view, rule_text, summary, verdict_text
from vaso.report.trace import Row, TraceTable, seconds, short_call, trace_table
from vaso.verdict import SpecResult

NARROWEST = 8
"""Narrowest column of text that is folded."""
REMARK = 16
"""Widest column of remarks."""
SPACE = 2
"""Columns of the terminal between two columns of a table."""
SKIPPED = "⋮"

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
    parts += [summary(result), *label_lines(result)]
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


def joint_counterexample_view(example: JointCounterexample) -> JointTrace:
    """The steps of a counterexample: sensors, what each member does in which line, values."""
    return JointTrace(example)


class JointTrace:
    """A joint counterexample as a table that shares out the width of the terminal."""

    def __init__(self, example: JointCounterexample) -> None:
        self.example = example
        self.headings, self.rows = joint_table(example)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """The table; what members do and the remarks are folded, other columns are not."""
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
        widths = self._widths(options.max_width)
        for name, width in zip(self.headings, widths, strict=True):
            justify: JustifyMethod = "right" if name in ("step", "time") else "left"
            table.add_column(_broken(name), justify=justify, width=width, overflow="fold")
        for cells, violated in self.rows:
            skipped = cells[0] == SKIPPED
            table.add_row(*cells, style="bold red" if violated else "dim" if skipped else "")
        yield table

    def _widths(self, total: int) -> list[int]:
        """The width of each column; the least that it needs, then more where text is folded."""
        natural = [self._natural(number) for number in range(len(self.headings))]
        acting = {f"{name} does" for name in self.example.members}
        folded = [n for n, name in enumerate(self.headings) if name in acting or not name]
        left = (
            total
            - SPACE * len(natural)
            - sum(width for number, width in enumerate(natural) if number not in folded)
        )
        for rank, number in enumerate(sorted(folded, key=lambda n: natural[n])):
            fair = left // (len(folded) - rank)
            natural[number] = max(NARROWEST, min(natural[number], fair))
            left -= natural[number]
        return natural

    def _natural(self, number: int) -> int:
        heading = _broken(self.headings[number]).split("\n")
        widest = max(map(len, [*heading, *(cells[number] for cells, _ in self.rows), ""]))
        return widest if self.headings[number] else min(widest, REMARK)


def joint_table(example: JointCounterexample) -> tuple[list[str], list[tuple[list[str], bool]]]:
    """A joint counterexample as text: headings, and cells with whether they are the violation."""
    trace = trace_table(_decided(example))
    shown = _active(example, trace)
    sensors = [trace.sensors[index] for index in shown]
    headings = [
        "step",
        *(["time"] if example.timed else []),
        *(name if name == TURN else f"{name}?" for name in sensors),
        *(f"{name} does" for name in example.members),
        *trace.values,
        "",
    ]
    rows = [(_cells(example, row, shown, len(headings)), row.violated) for row in trace.rows]
    return headings, rows


def _decided(example: JointCounterexample) -> JointCounterexample:
    """The behaviour up to the step after which nothing can repair the violation."""
    last = example.decided_at
    if last is None or last + 1 >= len(example.steps):
        return example
    return replace(
        example,
        steps=example.steps[: last + 1],
        doing=example.doing[: last + 1],
        loop_start=last + 1,
    )


def _active(example: JointCounterexample, trace: TraceTable) -> list[int]:
    """Columns of the sensors that a plan reads, the rule speaks of, or that are ever active."""
    read = {name for step in example.steps for name, _ in step.reads}
    shown = []
    for index, name in enumerate(example.steps[0].sensors):
        values = {step.sensors[name] for step in example.steps}
        mirrored = {n for n in example.formula.split() if n in read}
        if values != {False} or name in read or mirrored:
            shown.append(index)
    return shown if len(shown) < len(trace.sensors) else list(range(len(trace.sensors)))


def _cells(example: JointCounterexample, row: Row, sensors: Sequence[int], width: int) -> list[str]:
    if row.skipped:
        return [SKIPPED, *[""] * (width - 2), f"{row.skipped} more steps"]
    timed = [row.time] if example.timed else []
    does = [_does(did, first=row.step == 0) for did in example.doing[row.step]]
    step = f"↻ {row.steps}" if row.looping else row.steps
    sensed = [row.sensed[index] for index in sensors]
    notes = "; ".join([*_new_notes(example, row), *_plain(example, row)])
    return [step, *timed, *sensed, *does, *row.values, notes]


def _does(doing: Doing, *, first: bool) -> str:
    """The line and its call; in brackets where the member has not moved."""
    if doing.line is None and not doing.api:
        return "at rest"
    where = ":".join(str(part) for part in (doing.plan, doing.line) if part)
    call = f"{where}: {short_call(doing.api or doing.command)}" if where else doing.api
    return call if doing.moved or first else f"({call})"


def _new_notes(example: JointCounterexample, row: Row) -> Iterator[str]:
    """What happens to a member in a step, such as that its plan ends."""
    before = example.doing[row.step - 1] if row.step else ()
    for number, (name, did) in enumerate(
        zip(example.members, example.doing[row.step], strict=True)
    ):
        if did.note and not (before and before[number].note == did.note):
            yield f"{name}: {did.note}" if len(example.members) > 1 else did.note


def _plain(example: JointCounterexample, row: Row) -> Iterator[str]:
    """Remarks on the step itself; where it is decided, what follows does not matter."""
    told = {example.steps[row.step].note}
    decided = row.step == example.decided_at
    return (n for n in row.notes if n not in told and not (decided and n.startswith("then again")))


def _broken(name: str) -> str:
    """A long name with line breaks behind its dots and underscores."""
    return name if len(name) <= 10 else name.replace(".", ".\n").replace("_", "_\n")
