"""A counterexample as a table for people: what is sensed, what the robot does, which plan line."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from vaso.plan.transition_system import Label, Scalar
from vaso.verdict import Counterexample, Step, VerificationResult

if TYPE_CHECKING:
    from vaso.gradient.blame import Blame

SHOWN = 14
FOR_EVER = "goes on for ever"


@dataclass(frozen=True, slots=True)
class Row:
    """One step of the table, or a gap that stands for several steps like the ones around it.

    Attributes:
        step: Index of the step (of the first one in a gap).
        time: Seconds since the start, as text.
        sensed: A value per sensor column.
        does: The call that the robot executes.
        line: Plan line of that call.
        values: A value per value column.
        notes: Remarks.
        violated: True where the formula is violated beyond repair.
        looping: True for steps that repeat for ever.
        skipped: For a gap: how many steps it stands for; else 0.
    """

    step: int
    time: str = ""
    sensed: tuple[str, ...] = ()
    does: str = ""
    line: str = ""
    values: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    violated: bool = False
    looping: bool = False
    skipped: int = 0


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
        limit: The number of rows above which steps far from the violation become gaps.
    """
    values = concerned(example)
    kept = _kept(example, limit)
    rows = tuple(_rows(example, values, kept))
    return TraceTable(tuple(short_sensor(n) for n in _sensors(example)), values, rows)


def concerned(example: Counterexample) -> tuple[str, ...]:
    """Propositions of the formula whose values no sensor column shows already."""
    first = example.steps[0]
    words = dict.fromkeys(re.findall(r"[A-Za-z_]\w*", example.formula))
    named = [w for w in words if w in first.labels]
    return tuple(n for n in named if not any(_mirrors(example, n, s) for s in first.sensors))


def blame_of(result: VerificationResult) -> dict[str, Blame]:
    """For each violated formula with a counterexample: the plan lines to blame, and why."""
    from vaso.gradient.build import blames

    return {spec.formula: found for spec, found in blames(result)}


def marks_of(blame: Blame | None) -> dict[int, str]:
    """Plan lines to mark in a listing."""
    return dict.fromkeys(blame.lines, "") if blame else {}


def short_sensor(name: str) -> str:
    """``yolo_listener('people')`` as ``people``."""
    match = re.fullmatch(r"\w+\((['\"])(.+)\1\)", name)
    return match.group(2) if match else name


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


def _kept(example: Counterexample, limit: int) -> set[int]:
    """Indices worth showing: the start, the violation, the loop's start and the end."""
    count = len(example.steps)
    if count <= limit:
        return set(range(count))
    anchors = {0, example.loop_start, count - 1}
    if example.decided_at is not None:
        anchors |= {example.decided_at + d for d in (-1, 0, 1)}
    anchors |= {s.index for s in example.steps if s.note and _is_first_note(example, s)}
    return {i for i in anchors if 0 <= i < count}


def _is_first_note(example: Counterexample, step: Step) -> bool:
    return step.index == 0 or example.steps[step.index - 1].note != step.note


def _rows(example: Counterexample, values: tuple[str, ...], kept: set[int]) -> Iterator[Row]:
    gap: list[int] = []
    for step in example.steps:
        if step.index not in kept:
            gap.append(step.index)
            continue
        if len(gap) == 1:
            yield _row(example, example.steps[gap[0]], values)
        elif gap:
            yield Row(step=gap[0], skipped=len(gap))
        gap = []
        yield _row(example, step, values)


def _row(example: Counterexample, step: Step, values: tuple[str, ...]) -> Row:
    return Row(
        step=step.index,
        time=f"{step.index * example.dt:g} s",
        sensed=tuple(show(step.sensors[s]) for s in _sensors(example)),
        does=short_call(step.api or ("(at rest)" if step.index == 0 else step.command)),
        line=str(step.line or ""),
        values=tuple(show(step.labels[v]) for v in values),
        notes=tuple(_notes(example, step)),
        violated=step.index == example.decided_at,
        looping=step.index >= example.loop_start,
    )


def _notes(example: Counterexample, step: Step) -> Iterator[str]:
    if step.index == example.decided_at:
        yield "✗ violated here"
    if step.note:
        yield step.note
    last = len(example.steps) - 1
    if step.index == example.loop_start:
        yield FOR_EVER if example.loop_start == last else "the loop starts here"
    elif step.index == last:
        yield f"then again from step {example.loop_start}, for ever"
