"""A counterexample as a plain-text table: only the columns that the violated formula needs."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from vaso.errors import FormulaError
from vaso.gradient.failure import Failure, find_failure
from vaso.gradient.wording import value_text
from vaso.ltl import Formula, parse, propositions, variables
from vaso.plan.transition_system import Label
from vaso.verdict import Counterexample, Step

__all__ = ["MAX_ROWS", "trace_table"]

MAX_ROWS = 24
"""Rows beyond which steps that look like their neighbours are left out."""

Column = tuple[str, list[str]]
"""Header, and the text for every step."""


def trace_table(example: Counterexample, observed: frozenset[str] = frozenset()) -> str:
    """Show a counterexample as a monospaced table.

    One row a step: step, time, what the sensors say, what the plan does and in which line, numbers,
    what the plan reads, remarks; and where the behaviour repeats.

    Args:
        example: The counterexample.
        observed: The propositions that sensors decide.
    """
    formula = parse(example.formula)
    failure = _failure(formula, example, observed)
    columns = [*_columns(formula, example, observed), ("", _remarks(example, failure))]
    widths = [max(map(len, [header, *cells])) for header, cells in columns]
    lines = [_row([header for header, _ in columns], widths)]
    for first, last in _with_gaps(_chosen(example, failure)):
        if first == last:
            lines.append(_row([cells[first] for _, cells in columns], widths))
        else:
            lines.append(_gap(example, first, last))
    return "\n".join([*lines, _end(example)])


def _end(example: Counterexample) -> str:
    if example.recorded:
        return "(recorded on the robot up to this step)"
    return f"↺ back to step {example.loop_start}"


def _failure(formula: Formula, example: Counterexample, observed: frozenset[str]) -> Failure | None:
    try:
        return find_failure(formula, example, observed)
    except FormulaError:  # a value is missing: the table is still worth showing
        return None


# --------------------------------------------------------------------------------------- columns


def _columns(formula: Formula, example: Counterexample, observed: frozenset[str]) -> list[Column]:
    steps = example.steps
    named = propositions(formula)
    read = {name for s in steps for name, _ in s.reads}
    sensed = [n for n in sorted(observed) if n in named | read and n in steps[0].labels]
    others = [n for n in sorted(named - observed) if not _shown_by_command(n, steps)]
    columns = [
        ("step", [str(s.index) for s in steps]),
        ("time", [f"{s.index * example.dt:g} s" for s in steps]),
        *((n, [_text(s.labels.get(n)) for s in steps]) for n in [*sensed, *others]),
        ("command", [s.api or s.command for s in steps]),
        ("line", ["" if s.line is None else str(s.line) for s in steps]),
        *((n, [_text(s.labels.get(n)) for s in steps]) for n in sorted(variables(formula))),
        ("reads", [_reads(s, observed) for s in steps]),
    ]
    return [c for c in columns if c[0] in ("step", "time", "command") or any(c[1])]


def _shown_by_command(name: str, steps: Sequence[Step]) -> bool:
    """Tell whether the column "command" says it; at rest, where nothing was called, it does."""
    called = [(s.labels.get(name), s.api.partition("(")[0] == name) for s in steps if s.api]
    return bool(called) and all(value == here for value, here in called)


def _reads(step: Step, observed: frozenset[str]) -> str:
    read = dict.fromkeys((n, line) for n, line in step.reads if n in observed or "(" in n)
    return ", ".join(n if line is None else f"{n} (line {line})" for n, line in read)


def _text(value: Label | None) -> str:
    return "?" if value is None else value_text(value, "yes", "no")


def _remarks(example: Counterexample, failure: Failure | None) -> list[str]:
    remarks = [s.note for s in example.steps]
    if failure is not None:
        what = f"from here on never {failure.missing}" if failure.never else str(failure.missing)
        mark = f"← {what}" if failure.never else f"← violated: {what}"
        remarks[failure.step] = "; ".join(r for r in (mark, remarks[failure.step]) if r)
    return remarks


# ------------------------------------------------------------------------------------------ rows


def _row(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "  ".join(c.ljust(w) for c, w in zip(cells, widths, strict=True)).rstrip()


def _chosen(example: Counterexample, failure: Failure | None) -> list[int]:
    """Every step of a short trace; of a long one those at which something changes."""
    steps = example.steps
    if len(steps) <= MAX_ROWS:
        return list(range(len(steps)))
    marks = {0, example.loop_start, len(steps) - 1}
    if failure is not None:
        marks |= {f.step for f in failure.because} | {failure.step}
    shown = {i for m in marks for i in (m - 1, m, m + 1) if 0 <= i < len(steps)}
    changes = [j for j, (a, b) in enumerate(pairwise(steps), 1) if _differ(a, b)]
    # The changes nearest before the violation explain it best.
    last = failure.step if failure is not None else len(steps)
    for j in sorted(changes, key=lambda j: (j > last, abs(last - j))):
        if len(shown) < MAX_ROWS:
            shown.add(j)
    return sorted(shown)


def _differ(a: Step, b: Step) -> bool:
    return (a.api, a.command, a.line, a.note) != (b.api, b.command, b.line, b.note)


def _gap(example: Counterexample, first: int, last: int) -> str:
    part = example.steps[first - 1 : last + 1]
    same = not any(_differ(a, b) for a, b in pairwise(part))
    return f"… steps {first} to {last} {'go on like this' if same else 'are left out'} …"


def _with_gaps(indices: Sequence[int]) -> list[tuple[int, int]]:
    """Each index as (index, index), and what is left out between two of them as (first, last)."""
    rows: list[tuple[int, int]] = []
    for index in indices:
        after = rows[-1][1] + 1 if rows else 0
        if index == after + 1:
            rows.append((after, after))
        elif index > after:
            rows.append((after, index - 1))
        rows.append((index, index))
    return rows
