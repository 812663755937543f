"""Measurements as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from vaso.bench.exploring import Rate, together
from vaso.bench.many import Pass
from vaso.bench.measure import Point
from vaso.bench.scaling import families
from vaso.bench.suite import Suite

__all__ = ["duration", "markdown"]


def markdown(suite: Suite) -> str:
    """A page with a table for each benchmark."""
    parts = [
        "# Benchmark",
        f"{suite.machine}; {', '.join(f'{k} {v}' for k, v in suite.versions.items())}; "
        f"started {suite.started}, took {suite.seconds:.0f} s. "
        f"Medians; a run may take {suite.limit:g} s."
        + (" Small workloads only (`--quick`)." if suite.quick else ""),
        "## Many plans\n\n" + _many(suite.many),
        "## Satisfiability\n\n" + _points("rules", suite.satisfiability, suite.limit),
        "## Exploration\n\n" + _rates(suite.exploration),
    ]
    units = {family.name: family.unit for family in families()}
    parts += [
        f"## Growth with {name}\n\n{_points(units[name], points, suite.limit)}"
        for name, points in suite.scaling.items()
    ]
    return "\n\n".join(parts) + "\n"


def duration(seconds: float | None, limit: float | None = None) -> str:
    """A time for a table."""
    if seconds is None:
        return "-" if limit is None else f"> {limit:g} s"
    return f"{seconds * 1000:.0f} ms" if seconds < 1 else f"{seconds:.2f} s"


def _points(unit: str, points: Sequence[Point], limit: float) -> str:
    """A row for each workload; the last series is the yardstick of the ratio."""
    series = list(dict.fromkeys(p.series for p in points))
    rows = []
    for what in dict.fromkeys((p.x, p.what) for p in points):
        found = {p.series: p for p in points if (p.x, p.what) == what}
        times = [found[s].seconds if s in found else None for s in series]
        told = (p.outcome for p in found.values() if p.outcome and p.seconds is not None)
        outcomes = list(dict.fromkeys(told))
        shown = [duration(t, limit) for t in times]
        rows.append([f"{what[0]:g}", what[1], *shown, _ratio(times, limit), "; ".join(outcomes)])
    head = [unit, "workload", *series, f"{series[-2]} is quicker by", "outcome"]
    return _table(head, rows)


def _ratio(times: Sequence[float | None], limit: float) -> str:
    ours, plain = times[-2], times[-1]
    if not ours:
        return "-"
    ratio = (plain or limit) / ours
    return f"{'' if plain else '> '}{ratio:.1f}×" if ratio < 100 else f"> {ratio // 100 * 100:.0f}×"


def _rates(rates: Sequence[Rate]) -> str:
    rows = [
        [r.plan, f"{r.states:,}", f"{r.transitions:,}", duration(r.seconds), f"{r.per_second:,.0f}"]
        for r in [*rates, together(rates)]
    ]
    return _table(["plan", "states", "transitions", "time", "transitions/s"], rows)


def _many(passes: Iterable[Pass]) -> str:
    rows = [
        [
            p.name,
            f"{p.plans:,}",
            f"{p.rules:,}",
            f"{p.workers}",
            f"{p.known:,}",
            f"{p.seconds:.1f} s" if p.seconds >= 10 else f"{p.seconds:.2f} s",
            "-" if p.cpu is None else f"{p.cpu:.1f} s",
            f"{p.states:,}",
            f"{p.transitions:,}",
            ", ".join(f"{n} {v}" for v, n in p.verdicts.items()),
        ]
        for p in passes
    ]
    head = ["pass", "plans", "rules", "workers", "known", "time", "CPU"]
    head += ["states", "transitions", "verdicts"]
    return _table(head, rows)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
