"""A counterexample as a table for people: what is sensed, what the robot does, which plan line."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

from vaso.plan.transition_system import Label, Scalar
from vaso.verdict import Counterexample, Step, VerificationResult

if TYPE_CHECKING:
    from vaso.gradient.blame import Blame
    from vaso.skill import Skill

SHOWN = 14
FOR_EVER = "goes on for ever"


@dataclass(frozen=True, slots=True)
class Row:
    """One step of the table, or several: like one another, or left out.

    Attributes:
        step: Index of the step, or of the first one.
        last: Index of the last one.
        time: Seconds since the start, as text.
        sensed: A value per sensor column.
        does: The call that the robot executes.
        line: Plan line of that call.
        reads: What the plan reads, and in which lines.
        values: A value per value column; of several steps the first and the last one, or the range.
        notes: Remarks.
        violated: True where the formula is violated beyond repair.
        looping: True for steps that repeat for ever.
        skipped: How many steps are left out; 0 where they are shown.
    """

    step: int
    last: int
    time: str = ""
    sensed: tuple[str, ...] = ()
    does: str = ""
    line: str = ""
    reads: str = ""
    values: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    violated: bool = False
    looping: bool = False
    skipped: int = 0

    @property
    def steps(self) -> str:
        """The step, or ``first–last``."""
        return str(self.step) if self.last == self.step else f"{self.step}–{self.last}"


@dataclass(frozen=True, slots=True)
class TraceTable:
    """Rows with the headings of their sensor and value columns."""

    sensors: tuple[str, ...]
    values: tuple[str, ...]
    rows: tuple[Row, ...]


def trace_table(example: Counterexample, *, limit: int = SHOWN) -> TraceTable:
    """Lay a counterexample out as a table.

    Args:
        example: The counterexample.
        limit: The number of steps above which steps that are alike share a row. Where there are
            still more rows than that, those far from what matters are left out.
    """
    values = concerned(example)
    rows = [_row(example, run, values) for run in _runs(example, values, limit)]
    table = tuple(_without_far_ones(example, rows, limit))
    return TraceTable(tuple(short_sensor(n) for n in _sensors(example)), values, table)


def concerned(example: Counterexample) -> tuple[str, ...]:
    """Propositions of the formula whose values no sensor column shows already."""
    first = example.steps[0]
    words = dict.fromkeys(re.findall(r"[A-Za-z_][\w.]*", example.formula))
    named = [w for w in words if w in first.labels]
    return tuple(n for n in named if not any(_mirrors(example, n, s) for s in first.sensors))


def blame_of(result: VerificationResult, skill: Skill | None = None) -> dict[str, Blame]:
    """For each violated formula with a counterexample: the plan lines to blame, and why."""
    from vaso.gradient.build import blames

    return {spec.formula: found for spec, found in blames(result, skill)}


def marks_of(blame: Blame | None) -> dict[int, str]:
    """Plan lines to mark in a listing."""
    return dict.fromkeys(blame.lines, "") if blame else {}


def short_sensor(name: str) -> str:
    """``yolo_listener('people')`` as ``people``; what is in front of a dot stays."""
    match = re.fullmatch(r"((?:\w+\.)*)\w+\((['\"])(.+)\2\)", name)
    return f"{match.group(1)}{match.group(3)}" if match else name


def short_call(call: str) -> str:
    """``set_velocity(velocity=(0.0, 0.5, 0.0))`` as ``set_velocity((0, 0.5, 0))``."""
    single = re.sub(r"\((\w+)=(\([^()]*\)|[^(),=]*)\)$", r"(\2)", call)
    return re.sub(r"(?<![\w.])(-?\d+)\.0\b", r"\1", single)


def show(value: Scalar | Label) -> str:
    """A value for a cell: yes, no, or a number without noise."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def seconds(value: float) -> str:
    """A duration for a person: ``4 ms``, ``1.2 s``."""
    return f"{value * 1000:.0f} ms" if value < 1 else f"{value:.1f} s"


def _sensors(example: Counterexample) -> tuple[str, ...]:
    return tuple(example.steps[0].sensors)


def _mirrors(example: Counterexample, label: str, sensor: str) -> bool:
    return all(s.labels[label] is s.sensors[sensor] for s in example.steps)


Run = tuple[Step, ...]


def _runs(example: Counterexample, values: tuple[str, ...], limit: int) -> list[Run]:
    """The steps; in a long trace those that are alike together."""
    if len(example.steps) <= limit:
        return [(step,) for step in example.steps]
    alone = {0, example.loop_start, len(example.steps) - 1, example.decided_at}

    def kind(step: Step) -> object:
        flags = [step.labels[v] for v in values if isinstance(step.labels[v], bool)]
        same = (step.api, step.command, step.line, dict(step.sensors), step.reads, flags, step.note)
        return step.index if step.index in alone else same

    return [tuple(run) for _, run in groupby(example.steps, kind)]


def _without_far_ones(example: Counterexample, rows: list[Row], limit: int) -> Iterator[Row]:
    """Of many rows the start, the ones around the violation, and those around the loop."""
    matter = {0, example.loop_start, len(example.steps) - 1, example.decided_at}
    marks = {n for n, row in enumerate(rows) if row.step in matter or row.notes}
    kept = (
        {n + d for n in marks for d in (-1, 0, 1)} if len(rows) > limit else set(range(len(rows)))
    )
    for near, some in groupby(range(len(rows)), lambda n: n in kept):
        chosen = [rows[n] for n in some]
        if near or len(chosen) == 1:
            yield from chosen
        else:
            first, last = chosen[0].step, chosen[-1].last
            yield Row(step=first, last=last, skipped=last - first + 1)


def _row(example: Counterexample, run: Run, values: tuple[str, ...]) -> Row:
    first, last = run[0], run[-1]
    rest = "(at rest)" if first.index == 0 else first.command
    return Row(
        step=first.index,
        last=last.index,
        time=_time(first.index * example.dt, last.index * example.dt),
        sensed=tuple(show(first.sensors[s]) for s in _sensors(example)),
        does=short_call(first.api or rest),
        line=str(first.line or ""),
        reads=_reads(first),
        values=tuple(_range([s.labels[v] for s in run]) for v in values),
        notes=tuple(_notes(example, first)),
        violated=first.index == example.decided_at,
        looping=not example.recorded and first.index >= example.loop_start,
    )


def _time(start: float, end: float) -> str:
    return f"{start:g} s" if start == end else f"{start:g}–{end:g} s"


def _range(found: list[Label]) -> str:
    """A value, its change from first to last, or the range that it is in."""
    if len(set(found)) == 1:
        return show(found[0])
    if found in (sorted(found), sorted(found, reverse=True)):
        return f"{show(found[0])} → {show(found[-1])}"
    return f"{show(min(found))} … {show(max(found))}"


def _reads(step: Step) -> str:
    lines: dict[str, list[str]] = {}
    for name, line in step.reads:
        where = lines.setdefault(short_sensor(name), [])
        if line is not None and str(line) not in where:
            where.append(str(line))
    return ", ".join(f"{n} (line {', '.join(at)})" if at else n for n, at in lines.items())


def _notes(example: Counterexample, step: Step) -> Iterator[str]:
    if step.index == example.decided_at:
        yield "✗ violated here"
    if step.note:
        yield step.note
    last = len(example.steps) - 1
    if example.recorded:
        return
    if step.index == example.loop_start:
        yield FOR_EVER if example.loop_start == last else "the loop starts here"
    elif step.index == last:
        yield f"then again from step {example.loop_start}, for ever"
