"""Pictures as SVG files of their own: for notebooks, slides and web pages without our styles.

The HTML views say more. A figure is the part of them that also shows where styles are removed, as
GitHub and nbviewer do with the output of notebook cells.
"""

from __future__ import annotations

import importlib.resources
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Any

from vaso.ltl import Formula, evaluate, parse
from vaso.plan.transition_system import TransitionSystem
from vaso.report.graph import automaton_svg
from vaso.report.markup import Markup, el
from vaso.report.palette import variables
from vaso.report.trace import Row, TraceTable, trace_table
from vaso.verdict import Counterexample

__all__ = ["Figure", "automaton_figure", "timeline_figure"]

NAMES, COLUMN, LETTER = 130.0, 58.0, 7.9
HEAD, ROW, PAD = 46.0, 30.0, 10.0
WIDEST = 900.0
GRAPH_RULE = re.compile(r"^\.vaso svg\.graph (?:text|\.)[^{]*\{[^}]*\}", re.M)
FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif'


@dataclass(frozen=True)
class Figure:
    """A picture that shows itself as the output of a notebook cell.

    Attributes:
        svg: The text of an SVG file, with its styles inside; light and dark are the viewer's.
        text: What it shows, in one line, where there are no pictures.
    """

    svg: str
    text: str = ""

    def save(self, path: str | Path) -> Path:
        """Write the SVG file.

        Args:
            path: Where to.
        """
        target = Path(path)
        target.write_text(self.svg, encoding="utf-8")
        return target

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        return {"image/svg+xml": self.svg, "text/plain": self.text}


def automaton_figure(system: TransitionSystem, example: Counterexample | None = None) -> Figure:
    """What a plan can do, as a graph.

    Args:
        system: The automaton, such as ``result.system``.
        example: A behaviour to be brought out in red.
    """
    steps = example.steps if example is not None else ()
    states = [s.state for s in steps]
    loop = [states[example.loop_start]] if example is not None else []
    drawn = re.search("<svg.*</svg>", automaton_svg(system, [*states, *loop]), re.S)
    assert drawn is not None
    page = importlib.resources.files("vaso.report").joinpath("page.css").read_text(encoding="utf-8")
    rules = "\n".join(GRAPH_RULE.findall(page)).replace(".vaso svg.graph", ".vaso-figure")
    size = f"{len(system.states)} states, {system.transitions} transitions"
    return Figure(_alone(Markup(drawn.group(0)), rules), f"Automaton of the plan: {size}")


def timeline_figure(example: Counterexample, formulas: Sequence[str | Formula] = ()) -> Figure:
    """A counterexample over time: what is sensed, what the robot does, in which plan line.

    Args:
        example: The counterexample.
        formulas: Formulas to show below: in which steps each of them is true.

    Raises:
        FormulaError: A formula does not parse, or speaks of what the counterexample does not show.
    """
    truths = tuple(_truth(example, f) for f in formulas)
    parts = _parts(_Table(trace_table(example), truths))
    blocks = [_Block(part) for part in parts]
    tops = [0.0, *accumulate(block.height for block in blocks)]
    drawn = [
        el("g", block.markup(), transform=f"translate(0 {top:g})")
        for block, top in zip(blocks, tops, strict=False)
    ]
    told = f"A behaviour that violates {example.formula}"
    width = max(block.width for block in blocks)
    size = {"viewBox": f"0 0 {width:g} {tops[-1]:g}", "width": f"{width:g}"}
    svg = el("svg", el("title", told), drawn, role="img", **size)
    return Figure(_alone(svg, TIMELINE), told)


TIMELINE = """
.vaso-figure text { fill: var(--ink); font-size: 13px; }
.vaso-figure text.soft { fill: var(--soft); }
.vaso-figure text.strong { font-weight: 650; }
.vaso-figure text.yes { fill: var(--accent); font-weight: 650; }
.vaso-figure text.bad { fill: var(--fail); font-weight: 650; }
.vaso-figure text.call { font-family: ui-monospace, SFMono-Regular, Menlo, Consolas, monospace; }
.vaso-figure .on { fill: var(--accent-back); }
.vaso-figure .cell { fill: var(--code); stroke: var(--paper); stroke-width: 2; }
.vaso-figure .rule { stroke: var(--line); }
.vaso-figure .frame { fill: none; stroke: var(--fail); stroke-width: 2.5; }
.vaso-figure .loop { fill: none; stroke: var(--accent); stroke-width: 2; }
.vaso-figure .tip { fill: var(--accent); }
"""


# -- timeline --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Lane:
    """A line of the picture: a name, a text for each column, and how the texts look."""

    name: str
    cells: tuple[str, ...]
    style: str = ""


@dataclass(frozen=True)
class _Table:
    """A trace, and for some formulas the steps in which they are true."""

    trace: TraceTable
    truths: tuple[tuple[str, tuple[bool, ...]], ...] = ()

    @property
    def rows(self) -> tuple[Row, ...]:
        """The columns of the picture."""
        return self.trace.rows

    def part(self, start: int, end: int) -> _Table:
        """Some of the columns."""
        return replace(self, trace=replace(self.trace, rows=self.rows[start:end]))


def _truth(example: Counterexample, formula: str | Formula) -> tuple[str, tuple[bool, ...]]:
    parsed = parse(formula) if isinstance(formula, str) else formula
    labels = [dict(step.labels) for step in example.steps]
    return str(formula), evaluate(parsed, labels, example.loop_start)


def _lanes(table: _Table) -> Iterator[Lane]:
    trace = table.trace
    for n, sensor in enumerate(trace.sensors):
        yield Lane(f"{sensor} seen?", tuple(_at(row.sensed, n) for row in table.rows))
    yield Lane("robot does", tuple(row.does for row in table.rows), "call")
    yield Lane("plan line", tuple(row.line for row in table.rows))
    for n, name in enumerate(trace.values):
        yield Lane(name, tuple(_at(row.values, n) for row in table.rows))
    for name, truth in table.truths:
        yield Lane(name, tuple(_whether(truth, row) for row in table.rows))


def _at(cells: tuple[str, ...], index: int) -> str:
    return cells[index] if cells else ""


def _whether(truth: Sequence[bool], row: Row) -> str:
    """Whether a formula is true in the steps of a column."""
    if row.skipped:
        return ""
    found = set(truth[row.step : row.last + 1])
    return {True: "yes", False: "no"}[found.pop()] if len(found) == 1 else "at times"


def _edges(table: _Table) -> list[float]:
    """Where each column begins, and where the last one ends: each as wide as its text."""
    lanes = list(_lanes(table))
    edges = [max([NAMES, *((len(lane.name) + 2) * LETTER for lane in lanes)])]
    for n, row in enumerate(table.rows):
        texts = [row.time, _step(row), *(lane.cells[n] for lane in lanes)]
        edges.append(edges[-1] + max(COLUMN, max(map(len, texts)) * LETTER + 2 * PAD))
    return edges


def _parts(table: _Table) -> Iterator[_Table]:
    """The table, cut where it becomes too wide."""
    edges = _edges(table)
    start = 0
    for n in range(1, len(table.rows) + 1):
        is_last = n == len(table.rows)
        if is_last or edges[n + 1] - edges[start] > WIDEST - edges[0]:
            yield table.part(start, n)
            start = n


class _Block:
    """A part of the timeline that fits the width."""

    def __init__(self, table: _Table) -> None:
        self.table, self.edges = table, _edges(table)
        self.lanes = [lane for lane in _lanes(table) if any(lane.cells)]
        self.notes = list(_notes(table))
        self.bottom = HEAD + ROW * len(self.lanes)
        self.loops = any(row.looping for row in table.rows)
        self.width = self.edges[-1] + PAD
        self.height = self.bottom + (26 if self.loops else 8) + 20 * len(self.notes) + PAD

    def markup(self) -> list[Markup]:
        """The drawing, from 0 downwards."""
        under = self.height - PAD - 20 * len(self.notes) + 14
        return [
            *(part for n, row in enumerate(self.table.rows) for part in self._heading(row, n)),
            *(part for n, lane in enumerate(self.lanes) for part in self._lane(lane, n)),
            *self._frame(),
            *self._loop(),
            *(_text(note, PAD, under + 20 * n, "soft") for n, note in enumerate(self.notes)),
        ]

    def _heading(self, row: Row, n: int) -> Iterator[Markup]:
        middle = (self.edges[n] + self.edges[n + 1]) / 2
        if n == 0:
            yield _text("step", PAD, 18, "strong")
            yield _text("time", PAD, 36, "soft")
        yield _text(_step(row), middle, 18, "strong", "middle")
        yield _text(row.time, middle, 36, "soft", "middle")

    def _lane(self, lane: Lane, number: int) -> Iterator[Markup]:
        top = HEAD + ROW * number
        y = top + ROW / 2 + 4.5
        yield el("line", x1=0, x2=self.edges[-1], y1=top, y2=top, cls="rule")
        yield _text(lane.name, PAD, y, "strong")
        for (left, right), text in zip(pairwise(self.edges), lane.cells, strict=True):
            box = {"x": left, "y": top + 1, "width": right - left, "height": ROW - 2}
            if text == "yes":
                yield el("rect", cls="on", **box)
            elif lane.style and text:
                yield el("rect", cls="cell", rx=5, **box)
            style = {"yes": "yes", "no": "soft"}.get(text, lane.style)
            yield _text(text, (left + right) / 2, y, style, "middle")

    def _frame(self) -> Iterator[Markup]:
        """A red frame around the step in which the rule is violated for good."""
        for (left, right), row in zip(pairwise(self.edges), self.table.rows, strict=True):
            if row.violated:
                box = {"x": left, "width": right - left, "y": 2, "height": self.bottom}
                yield el("rect", cls="frame", rx=6, **box)

    def _loop(self) -> Iterator[Markup]:
        """An arrow from the end back to where the behaviour repeats."""
        if not self.loops:
            return
        start = next(n for n, row in enumerate(self.table.rows) if row.looping)
        left, right, y = self.edges[start] + 14, self.edges[-1] - 14, self.bottom
        yield el("path", d=f"M{right:g} {y + 5:g} V{y + 17:g} H{left:g} V{y + 10:g}", cls="loop")
        tip = f"M{left - 5:g} {y + 11:g} L{left:g} {y + 4:g} L{left + 5:g} {y + 11:g} z"
        yield el("path", d=tip, cls="tip")


def _step(row: Row) -> str:
    return f"… {row.skipped} more …" if row.skipped else row.steps


def _notes(table: _Table) -> Iterator[str]:
    for row in table.rows:
        if row.notes:
            yield f"step {row.steps}: {'; '.join(row.notes)}"


def _text(text: str, x: float, y: float, cls: str, anchor: str | None = None) -> Markup:
    return el("text", text, x=f"{x:g}", y=f"{y:g}", text_anchor=anchor, cls=cls or None)


# -- files -----------------------------------------------------------------------------------------


def _fitting(width: re.Match[str]) -> str:
    return f'width="{min(float(width.group(1)), WIDEST):g}"'


def _alone(svg: Markup, rules: str) -> str:
    """A drawing as a file of its own: with name space, colours and styles."""
    opening, content = svg.split(">", 1)
    opening = re.sub(' class="[^"]*"', "", opening)
    opening = re.sub('width="([^"]*)"', _fitting, opening, count=1)
    frame = ".vaso-figure { display: block; max-width: 100%; height: auto; "
    style = f"{frame}background: var(--paper); font-family: {FONT}; }}\n{rules}"
    styles = el("style", Markup(variables(".vaso-figure") + style))
    space = 'xmlns="http://www.w3.org/2000/svg" class="vaso-figure"'
    return f"{opening} {space}>{styles}{content}"
