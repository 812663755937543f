"""A comparison in the terminal: a line for each optimizer that fits 80 columns, without colour."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from vaso.comparison.rows import Row
from vaso.comparison.statistic import Statistic, Summary
from vaso.report.terminal_runs import count, percent

if TYPE_CHECKING:
    from vaso.comparison.result import Comparison

HEADINGS = {
    "safety": "safety",
    "safety_unseen": "unseen\nsafety",
    "completion": "comple-\ntion",
    "steps": "steps",
    "loss_calls": "loss\ncalls",
    "lm_calls": "model\ncalls",
    "tokens": "tokens",
    "cost": "cost",
    "seconds": "time\n(s)",
}
WIDEST = 10
WITH_MODEL = ("lm_calls", "tokens", "cost")


def comparison_view(comparison: Comparison) -> Group:
    """The table, what it was measured on, and what went wrong."""
    parts: list[RenderableType] = [Text(headline(comparison), style="bold")]
    if comparison.rows:
        parts += [_table(comparison), Text(_legend(comparison), style="dim")]
    parts += _problems(comparison.rows)
    if comparison.problem:
        parts.append(Text(comparison.problem, style="red"))
    if comparison.interrupted:
        there = sum(not row.interrupted for row in comparison.rows)
        text = f"interrupted: {there} of {count(comparison.planned, 'run')} came to an end"
        parts.append(Text(text, style="yellow"))
    return Group(*parts)


def plain_text(comparison: Comparison) -> str:
    """The same as text of 80 columns."""
    text = io.StringIO()
    Console(file=text, width=80, highlight=False).print(comparison_view(comparison))
    return text.getvalue().rstrip("\n")


def headline(comparison: Comparison) -> str:
    """The skill, its tasks, and where it starts."""
    setup = comparison.setup
    tasks = count(len(setup.seen), "task")
    tasks += f", {len(setup.unseen)} unseen" if setup.unseen else ""
    before = Statistic.of(row.safety_before for row in comparison.rows)
    start = "" if before is None else f", safety {percent(before.mean)} at the start"
    return f"{setup.skill}: {tasks}{start}"


def columns(comparison: Comparison) -> list[str]:
    """The columns that have something to say."""
    there = {name for s in comparison.summary().values() for name in s.statistics}
    asked = any(row.lm_calls for row in comparison.rows)
    paid = any(row.cost for row in comparison.rows)
    left_out = {*(() if asked else WITH_MODEL), *(() if paid else ("cost",))}
    return [name for name in HEADINGS if name not in left_out and name in there]


def _table(comparison: Comparison) -> Table:
    shown = columns(comparison)
    several = any(summary.runs > 1 for summary in comparison.summary().values())
    narrow = {"padding": 0} if "cost" in shown else {"padding": (0, 1), "collapse_padding": True}
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, **narrow)
    table.add_column("optimizer", overflow="fold")
    table.add_column("verified", no_wrap=True)
    for name in shown:
        table.add_column(HEADINGS[name], justify="right", no_wrap=True)
    for summary in comparison.summary().values():
        cells = [_cell(summary, name, several) for name in shown]
        table.add_row(_name(summary.optimizer), _verified(summary), *cells)
    return table


def _name(optimizer: str) -> Text:
    """The name of an optimizer; a long one is broken behind a hyphen."""
    return Text(optimizer.replace("-", "-\n") if len(optimizer) > WIDEST else optimizer)


def _verified(summary: Summary) -> Text:
    mark, style = ("✓", "green") if summary.verified == summary.runs else ("✗", "red")
    return Text(f"{mark} {summary.verified}/{summary.runs}", style=style)


def _cell(summary: Summary, name: str, several: bool) -> Text:
    mean, sd = (part.removesuffix(" s") for part in summary.shown(name))
    text = Text(mean)
    return text.append(f"\n{sd}", style="dim") if several and sd else text


def _legend(comparison: Comparison) -> str:
    summaries = comparison.summary().values()
    runs = max(summary.runs for summary in summaries)
    what = f"mean ± standard deviation over {runs} seeds" if runs > 1 else "one seed"
    parts = [f"{what}, on {comparison.machines}"]
    if comparison.setup.model:
        parts.append(f"model {comparison.setup.model}")
    if workers := in_parallel(comparison):
        parts.append(f"{workers} runs at a time, so times do not compare with those of runs alone")
    return "; ".join(parts)


def in_parallel(comparison: Comparison) -> int:
    """How many runs shared the machine; 0 where each had it alone."""
    workers = max((row.workers for row in comparison.rows), default=1)
    return workers if workers > 1 else 0


def _problems(rows: Iterable[Row]) -> Iterator[Text]:
    """Why runs failed, or ended without a verified skill; equal ones together."""
    found: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        if row.error:
            found.setdefault((row.optimizer, "✗ failed", row.error), []).append(row)
        elif not row.verified and not row.interrupted:
            found.setdefault((row.optimizer, "not verified", row.stop_reason), []).append(row)
    for (optimizer, what, why), same in found.items():
        seeds = ", ".join(str(row.seed) for row in same)
        which = f"{optimizer}, seed{'' if len(same) == 1 else 's'} {seeds}: "
        yield Text(which).append(what, style="red").append(f": {why}")
