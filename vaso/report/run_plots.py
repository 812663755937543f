"""The course of one optimization as plots: over steps, and over loss calls."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import TYPE_CHECKING

from vaso.report.markup import Markup, el
from vaso.report.plot import MEDIUM, Point, Series, responsive
from vaso.report.terminal_runs import count, percent

if TYPE_CHECKING:
    from vaso.optimizers.result import OptimizationResult, StepRecord

SAFETY, COMPLETION, TURNED_DOWN = 0, 1, 7


def convergence(result: OptimizationResult) -> Markup:
    """Safety and task completion over steps, and over what was spent to get there."""
    plots = [_plot(result, [0, *(s.step for s in result.steps)], "steps")]
    calls = [s.loss_calls for s in result.steps]
    if calls and all(calls):
        plots.append(_plot(result, [min(len(result.values), calls[0]), *calls], "loss calls"))
    return el("div", plots, cls="plots")


def _plot(result: OptimizationResult, xs: Sequence[int], x_label: str) -> Markup:
    """A plot over the positions of the start and of each step."""
    series = [_safety(result, xs), _completion(result, xs), *_in_vain(result, xs)]
    before, after = percent(result.safety_before), percent(result.safety)
    return responsive(
        [s for s in series if s.points],
        width=MEDIUM,
        x_label=x_label,
        y_label="share",
        y_range=(0, 1),
        percent=True,
        whole=True,
        x_start=0,
        title=f"Safety and task completion over {x_label}",
        description=f"Safety: {before} before, {after} after {count(len(result.steps), 'step')}.",
    )


def _safety(result: OptimizationResult, xs: Sequence[int]) -> Series:
    points = [Point(xs[0], result.safety_before, title="the skill as it was given")]
    points += [
        Point(x, s.safety, title=_title(s)) for x, s in zip(xs[1:], result.steps, strict=True)
    ]
    accepted = {n for n, step in enumerate(result.steps, start=1) if step.accepted}
    return Series(points, "safety", SAFETY, stairs=True, marked=frozenset({0} | accepted))


def _completion(result: OptimizationResult, xs: Sequence[int]) -> Series:
    known = [v.completion for v in result.before.values()]
    points = [Point(xs[0], statistics.fmean(known))] if len(known) == len(result.values) > 0 else []
    points += [Point(x, s.completion) for x, s in zip(xs[1:], result.steps, strict=True)]
    return Series(points, "task completion", COMPLETION, stairs=True, marked=frozenset())


def _in_vain(result: OptimizationResult, xs: Sequence[int]) -> list[Series]:
    """Steps in which nothing was accepted, and candidates that were turned down."""
    empty, turned_down = [], []
    for x, step in zip(xs[1:], result.steps, strict=True):
        if not step.accepted:
            empty.append(Point(x, step.safety, "rejected", _title(step)))
        for tried in step.tried:
            if tried.score is not None:
                title = f"step {step.step}: {tried.note}: {tried.reason}"
                turned_down.append(Point(x, tried.score, title=title))
    return [
        Series(turned_down, "turned down", TURNED_DOWN, joined=False),
        Series(empty, "nothing accepted", SAFETY, joined=False),
    ]


def _title(step: StepRecord) -> str:
    return f"step {step.step}: safety {percent(step.safety)}; {step.note or 'nothing accepted'}"
