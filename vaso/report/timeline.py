"""A counterexample on an HTML page: time runs to the right; sensors, commands, values below."""

from __future__ import annotations

import re

from vaso.report.markup import Markup, el
from vaso.report.plot import Point, line_plot
from vaso.report.trace import Row, TraceTable, concerned, trace_table
from vaso.verdict import Counterexample


def timeline(example: Counterexample) -> Markup:
    """The counterexample as a table with one column a step, and a curve for each number."""
    table = trace_table(example)
    curves = [_curve(example, name) for name in concerned(example) if _is_number(example, name)]
    return el("div", el("div", _table(table), cls="scroll"), curves)


def _table(table: TraceTable) -> Markup:
    steps = [_heading(row) for row in table.rows]
    lines = [
        _line(f"{s} seen?", [_at(r.sensed, i) for r in table.rows], table)
        for i, s in enumerate(table.sensors)
    ]
    lines.append(_line("robot does", [r.does for r in table.rows], table))
    lines.append(_line("plan line", [r.line for r in table.rows], table))
    lines += [
        _line(v, [_at(r.values, i) for r in table.rows], table) for i, v in enumerate(table.values)
    ]
    notes = [el("td", "; ".join(r.notes)) for r in table.rows]
    lines.append(el("tr", el("th", "", scope="row"), notes, cls="note"))
    head = el("thead", el("tr", el("th", "step", scope="row"), steps))
    return el("table", head, el("tbody", lines), cls="timeline")


def _heading(row: Row) -> Markup:
    if row.skipped:
        return el("th", f"… {row.skipped} more …", cls="gap")
    loop = "↻ " if row.looping else ""
    return el(
        "th",
        f"{loop}{row.step}",
        el("br"),
        el("span", row.time, cls="soft small"),
        cls=_classes(row),
    )


def _line(name: str, cells: list[str], table: TraceTable) -> Markup:
    found = [_cell(text, row) for text, row in zip(cells, table.rows, strict=True)]
    return el("tr", el("th", name, scope="row"), found)


def _cell(text: str, row: Row) -> Markup:
    if row.skipped:
        return el("td", "…", cls="gap")
    return el("td", text, cls="bad" if row.violated else {"yes": "yes", "no": "no"}.get(text))


def _at(cells: tuple[str, ...], index: int) -> str:
    return cells[index] if cells else ""


def _classes(row: Row) -> str | None:
    return " ".join(c for c, on in (("bad", row.violated), ("loop", row.looping)) if on) or None


def _is_number(example: Counterexample, name: str) -> bool:
    values = [s.labels[name] for s in example.steps]
    return not any(isinstance(v, bool) for v in values) and len(set(values)) > 1


def _curve(example: Counterexample, name: str) -> Markup:
    points = [
        Point(
            s.index * example.dt,
            float(s.labels[name]),
            "bad" if s.index == example.decided_at else "",
        )
        for s in example.steps
    ]
    return line_plot(points, x_label="seconds", y_label=name, limit=_limit(example, name))


def _limit(example: Counterexample, name: str) -> float | None:
    """The number that the formula compares with, if it is the only one."""
    pattern = rf"\b{re.escape(name)}\s*[<>]=?\s*(-?\d+(?:\.\d+)?)"
    found = {float(n) for n in re.findall(pattern, example.formula)}
    return found.pop() if len(found) == 1 else None
