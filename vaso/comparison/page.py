"""A comparison as a self-contained HTML page, and as the output of a notebook cell."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING
from urllib.parse import quote

from vaso.comparison.columns import COLUMNS, show
from vaso.comparison.rows import Row
from vaso.comparison.running import REPORT
from vaso.comparison.statistic import Summary
from vaso.comparison.table import columns, headline, in_parallel
from vaso.report.listing import diff_block
from vaso.report.markup import Markup, el, join
from vaso.report.page import cell, page
from vaso.report.pieces import badge, folded
from vaso.report.plot import NARROW, WIDTH
from vaso.report.terminal_runs import count

if TYPE_CHECKING:
    from vaso.comparison.result import Comparison

MORE = {"steps": "accepted", "loss_calls": "memo_hits"}
STYLE = """
.vaso table.numbers { font-variant-numeric: tabular-nums; }
.vaso table.numbers .number { text-align: right; white-space: nowrap; }
.vaso table.numbers thead th { white-space: normal; vertical-align: bottom; }
"""
READING = (
    "Share of the rules that the plans keep, mean over the tasks, after so many verifications of a "
    "candidate. A line is the mean over the seeds, a band one standard deviation to each side."
)


def comparison_html(comparison: Comparison) -> str:
    """A page for a file; it links to the reports of the runs in the folders beside it."""
    title = f"VASO comparison of optimizers on {comparison.setup.skill}"
    return page(title, *_parts(comparison, links=True))


def comparison_cell(comparison: Comparison) -> str:
    """The same for a notebook."""
    return cell(*_parts(comparison, links=False))


def _parts(comparison: Comparison, *, links: bool) -> Iterable[Markup]:
    yield el("style", Markup(STYLE))
    yield el("h1", f"Optimizers on {comparison.setup.skill}")
    yield el("p", headline(comparison), cls="soft")
    if comparison.interrupted:
        there = sum(not row.interrupted for row in comparison.rows)
        text = f"{there} of {count(comparison.planned, 'run')} have come to an end so far."
        yield el("p", text, cls="banner")
    if comparison.rows:
        yield _summary(comparison)
        yield el("h2", "Convergence")
        yield el("p", READING, cls="soft")
        yield el("div", _plot(comparison), cls="card")
        yield el("h2", "Runs")
        yield _runs(comparison, links)
        yield join([_details(row, links) for row in comparison.rows])
    yield el("h2", "What was measured, and on what")
    yield _facts(comparison)
    yield folded("What the columns mean", _meanings())


# -- tables ----------------------------------------------------------------------------------------


def _summary(comparison: Comparison) -> Markup:
    names = columns(comparison)
    head = [el("th", "optimizer", scope="col"), el("th", "verified", scope="col")]
    head += [_heading(name) for name in names]
    rows = [_summary_row(summary, names) for summary in comparison.summary().values()]
    note = "Mean ± standard deviation of the sample over the seeds; – where there is none."
    if workers := in_parallel(comparison):
        note += f" {workers} runs at a time: their times do not compare with those of runs alone."
    return join(_table(head, rows), el("p", note, cls="soft small"))


def _summary_row(summary: Summary, names: Sequence[str]) -> Markup:
    kind = "pass" if summary.verified == summary.runs else "fail"
    verified = badge(f"{summary.verified} of {summary.runs}", kind)
    cells = [_mean(*summary.shown(name)) for name in names]
    return el("tr", el("th", summary.optimizer, scope="row"), el("td", verified), cells)


def _mean(mean: str, sd: str) -> Markup:
    below = join(el("br"), el("span", sd, cls="soft")) if sd else None
    return el("td", mean, below, cls="number")


def _value(text: str) -> Markup:
    return el("td", text, cls="number")


def _heading(name: str) -> Markup:
    column = COLUMNS[name]
    return el("th", column.label, scope="col", title=column.meaning, cls="number")


def _runs(comparison: Comparison, links: bool) -> Markup:
    names = [n for name in columns(comparison) for n in (name, MORE.get(name)) if n]
    head = [el("th", "optimizer", scope="col"), _heading("seed"), el("th", "verified", scope="col")]
    head += [_heading(name) for name in names]
    return _table(head, [_run_row(row, names, links) for row in comparison.rows])


def _run_row(row: Row, names: Sequence[str], links: bool) -> Markup:
    return el(
        "tr",
        el("th", _link(row, row.optimizer) if links else row.optimizer, scope="row"),
        _value(str(row.seed)),
        el("td", _verdict(row)),
        [_value(show(name, getattr(row, name))) for name in names],
    )


def _link(row: Row, text: str) -> Markup | str:
    """A text that leads to the report of a run, where it has one."""
    if not row.folder or row.safety is None:
        return text
    return el("a", text, href=f"{quote(row.folder)}/{REPORT}")


def _verdict(row: Row) -> Markup:
    if row.error:
        return badge("failed", "fail")
    if row.interrupted:
        return badge("interrupted")
    return badge("✓ yes", "pass") if row.verified else badge("✗ no", "fail")


def _table(head: list[Markup], rows: list[Markup]) -> Markup:
    table = el("table", el("thead", el("tr", head)), el("tbody", rows), cls="numbers")
    return el("div", el("div", table, cls="scroll", tabindex=0), cls="card")


# -- details ---------------------------------------------------------------------------------------


def _plot(comparison: Comparison) -> Markup:
    wide, narrow = (comparison.svg(width=width) for width in (WIDTH, NARROW))
    both = [el("div", wide, cls="wide"), el("div", narrow, cls="narrow")]
    return el("div", both, cls=f"either at-{WIDTH}")


def _details(row: Row, links: bool) -> Markup:
    title = join(f"{row.name} ", _verdict(row))
    notes = [el("li", note) for note in row.notes if note]
    violated = [el("li", el("code", rule)) for rule in row.violated]
    return folded(
        title,
        join(
            el("p", row.error, cls="banner fail") if row.error else None,
            el("p", f"It stopped because {row.stop_reason}.") if row.stop_reason else None,
            el("p", _link(row, "Report of the run")) if links and row.folder else None,
            join(el("p", "Accepted:"), el("ul", notes)) if notes else None,
            join(el("p", "Still violated:"), el("ul", violated)) if violated else None,
            diff_block(row.diff) if row.diff else None,
        ),
    )


def _facts(comparison: Comparison) -> Markup:
    setup, machine = comparison.setup, comparison.machine
    limits = [f"{v:g} {n.replace('_', ' ')}" for n, v in setup.budget.items() if v is not None]
    options = ", ".join(f"{n} {v}" for n, v in setup.model_options.items())
    model = f"{setup.model} ({options})" if options else setup.model
    facts = {
        "model": model or "none",
        "plans": f"{setup.planner} {setup.planner_model}".strip(),
        "budget of a run": ", ".join(limits) or "no limit",
        "textual gradients": setup.level,
        "machine": comparison.machines,
        "packages": ", ".join(f"{n} {v}" for n, v in machine.packages.items()),
        "started": machine.started,
    }
    lists = [("Tasks", setup.seen), ("Unseen tasks", setup.unseen)]
    return join(
        el("table", [el("tr", el("th", n, scope="row"), el("td", v)) for n, v in facts.items()]),
        [folded(f"{n} ({len(t)})", el("ul", [el("li", x) for x in t])) for n, t in lists if t],
    )


def _meanings() -> Markup:
    rows = [
        el("tr", el("th", c.label, scope="row"), el("td", el("code", c.name)), el("td", c.meaning))
        for c in COLUMNS.values()
    ]
    return el("div", el("table", rows), cls="scroll", tabindex=0)
