"""A counterexample on an HTML page: time runs to the right; sensors, commands, values below."""

from __future__ import annotations

import re

from vaso.report.markup import Markup, el, join
from vaso.report.plot import MEDIUM, Point, Series, responsive
from vaso.report.trace import Row, TraceTable, concerned, trace_table
from vaso.verdict import Counterexample

DOTTED = 20
NO_BREAK = "\u00a0"


def timeline(example: Counterexample) -> Markup:
    """The counterexample as a table with one column a step, and a curve for each number."""
    table = trace_table(example)
    scroll = el("div", _table(table), cls="scroll", tabindex=0)
    curves = [_curve(example, name) for name in concerned(example) if _is_number(example, name)]
    return el("div", scroll, el("div", curves, cls="plots") if curves else None)


def _table(table: TraceTable) -> Markup:
    rows = table.rows
    lines = [
        *(_line(f"{s} seen?", [_at(r.sensed, i) for r in rows], table, "sensed")
          for i, s in enumerate(table.sensors)),
        _line("plan reads", [r.reads.replace(", ", "\n") for r in rows], table, "reads"),
        _line("robot does", [r.does for r in rows], table, "does"),
        _line("plan line", [r.line for r in rows], table, "line"),
        *(_line(v, [_at(r.values, i) for r in rows], table, "value")
          for i, v in enumerate(table.values)),
    ]  # fmt: skip
    notes = [el("td", "; ".join(r.notes), cls=_classes(r)) for r in rows]
    lines.append(el("tr", el("th", "", scope="row"), notes, cls="note"))
    head = el("tr", el("th", "step", scope="row"), [_heading(r) for r in rows])
    shown = [line for line in lines if line]
    return el("table", el("thead", head), el("tbody", shown), cls="timeline")


def _heading(row: Row) -> Markup:
    if row.skipped:
        return el("th", f"… {row.skipped} more …", scope="col", cls="gap")
    loop = "↻ " if row.looping else ""
    time = el("span", row.time, cls="soft small")
    return el("th", f"{loop}{row.steps}", el("br"), time, scope="col", cls=_classes(row))


def _line(name: str, cells: list[str], table: TraceTable, kind: str) -> Markup:
    """A row of the table; empty where no step has anything to say."""
    if not any(cells):
        return Markup()
    found = [_cell(text, row) for text, row in zip(cells, table.rows, strict=True)]
    return el("tr", el("th", name, scope="row"), found, cls=kind)


def _cell(text: str, row: Row) -> Markup:
    if row.skipped:
        return el("td", "…", cls="gap")
    value = {"yes": "yes", "no": "no"}.get(text)
    return el("td", _breakable(text), cls=" ".join(c for c in (value, _classes(row)) if c) or None)


def _breakable(text: str) -> Markup:
    """A call breaks after its name and between its arguments, but not inside of a vector."""
    name, opening, arguments = text.partition("(")
    if not opening or "((" not in text:
        return join(text)
    return join(f"{name}(", el("wbr"), arguments.replace(" ", NO_BREAK))


def _at(cells: tuple[str, ...], index: int) -> str:
    return cells[index] if cells else ""


def _classes(row: Row) -> str | None:
    return " ".join(c for c, on in (("bad", row.violated), ("loop", row.looping)) if on) or None


def _is_number(example: Counterexample, name: str) -> bool:
    values = [s.labels[name] for s in example.steps]
    return not any(isinstance(v, bool) for v in values) and len(set(values)) > 1


def _curve(example: Counterexample, name: str) -> Markup:
    points = []
    for step in example.steps:
        time, value = step.index * example.dt, float(step.labels[name])
        bad = "bad" if step.index == example.decided_at else ""
        points.append(Point(time, value, bad, f"step {step.index}, {time:g} s: {value:.6g}"))
    few = frozenset(range(len(points))) if len(points) <= DOTTED else frozenset()
    limit = _limit(example, name)
    return responsive(
        [Series(points, marked=few)],
        width=MEDIUM,
        x_label="seconds",
        y_label=name,
        limit=limit[1] if limit else None,
        limit_label=f"{limit[0]} {limit[1]:g}" if limit else "",
        title=f"{name} over time in the behaviour that violates {example.formula}",
    )


def _limit(example: Counterexample, name: str) -> tuple[str, float] | None:
    """The comparison with a number in the formula, if there is only one."""
    pattern = rf"\b{re.escape(name)}\s*([<>]=?)\s*(-?\d+(?:\.\d+)?)"
    found = {(sign, float(number)) for sign, number in re.findall(pattern, example.formula)}
    return found.pop() if len(found) == 1 else None
