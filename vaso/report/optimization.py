"""An optimization on an HTML page: convergence, steps, rules, plans."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from vaso.report.listing import diff_block, listing
from vaso.report.markup import Markup, el, join
from vaso.report.pieces import (
    automaton_section,
    badge,
    problem_banner,
    rule_rows,
    verdict_badge,
    verdict_facts,
    violations,
)
from vaso.report.plot import Point, line_plot
from vaso.report.terminal_runs import count, percent
from vaso.verdict import Verdict, VerificationResult

if TYPE_CHECKING:
    from vaso.optimizers.base import Case, LossValue
    from vaso.optimizers.result import OptimizationResult, StepRecord, Tried

ORDER = (Verdict.FAIL, Verdict.UNSUPPORTED, Verdict.UNKNOWN, Verdict.PASS)


def optimization_parts(result: OptimizationResult) -> Iterable[Markup]:
    """The sections of the page."""
    yield el("h1", f"Optimization of {result.initial_skill.name}")
    yield _facts(result)
    yield el("h2", "Safety after each step")
    yield el("p", "Share of the rules that the plans keep, mean over the tasks.", cls="soft")
    yield el("div", convergence(result), cls="card")
    yield el("h2", "Rules at the end")
    yield _rule_table(result)
    if result.diff:
        yield el("h2", "What changed in the skill")
        yield diff_block(result.diff)
    yield el("h2", "Steps")
    yield join([_step(s) for s in result.steps]) or el("p", "No step was needed.", cls="soft")
    yield el("h2", "Plans at the end")
    yield join([_case(c, v, n == 0) for n, (c, v) in enumerate(result.values.items())])


def _facts(result: OptimizationResult) -> Markup:
    word = badge("✓ VERIFIED", "pass") if result.verified else badge("✗ NOT VERIFIED", "fail")
    facts = [
        f"safety {percent(result.safety_before)} → {percent(result.safety)}",
        f"task completion {percent(result.completion)}",
        f"optimizer {result.optimizer}",
        str(result.spent),
    ]
    line = el("div", word, [el("span", f) for f in facts], cls="facts")
    kept = "The best version so far is kept." if result.diff else "Nothing better was found."
    why = f"{kept} The run stopped because {result.stop_reason}."
    return join(line, None if result.verified else el("p", why, cls="banner"))


def convergence(result: OptimizationResult) -> Markup:
    """Safety over steps; a hollow mark is a step in which nothing was accepted."""
    points = [Point(0, result.safety_before, title="the skill as it was given")]
    for step in result.steps:
        title = f"step {step.step}: {percent(step.safety)} {step.note}".strip()
        points.append(Point(step.step, step.safety, "" if step.accepted else "rejected", title))
    return line_plot(
        points, x_label="step", y_label="safety", y_range=(0, 1), percent=True, whole=True
    )


def _rule_table(result: OptimizationResult) -> Markup:
    """Each rule over all tasks: its worst verdict, and how many tasks keep it."""
    found: dict[str, list[Verdict]] = {}
    english: dict[str, str] = {}
    for outcome in _results(result.values):
        for spec in outcome.specs:
            found.setdefault(spec.spec, []).append(spec.verdict)
            english[spec.spec] = spec.english
    tasks = len(result.values)
    rows = [_rule_row(rule, english[rule], verdicts, tasks) for rule, verdicts in found.items()]
    return el("div", rows, cls="card")


def _rule_row(rule: str, english: str, verdicts: list[Verdict], tasks: int) -> Markup:
    worst = next(v for v in ORDER if v in verdicts)
    text = [el("p", el("code", rule)), el("p", english, cls="soft")]
    kept = f"{sum(map(bool, verdicts))} of {count(tasks, 'task')}"
    return el(
        "div",
        el("div", verdict_badge(worst)),
        el("div", text),
        el("span", kept, cls="soft small"),
        cls="rule",
    )


def _results(values: Mapping[Case, LossValue]) -> list[VerificationResult]:
    return [v.result for v in values.values() if v.result is not None]


def _step(step: StepRecord) -> Markup:
    word = badge("✓ accepted", "pass") if step.accepted else badge("✗ nothing accepted", "fail")
    title = el("h3", f"Step {step.step} ", word, f" safety {percent(step.safety)}")
    violated = [el("li", el("code", rule)) for rule in step.violated]
    return el(
        "div",
        title,
        el("p", step.note) if step.note else None,
        el("p", step.error, cls="banner fail") if step.error else None,
        diff_block(step.diff) if step.diff else None,
        el("p", "Still violated:", cls="small") if violated else None,
        el("ul", violated) if violated else None,
        _folded("Textual gradient", el("pre", step.gradient, cls="gradient")),
        _tried(step) if step.tried else None,
        cls="card",
    )


def _tried(step: StepRecord) -> Markup:
    items = [el("li", _attempt(t)) for t in step.tried]
    return _folded(f"{step.tried_count} candidates were turned down", el("ul", items, cls="small"))


def _attempt(tried: Tried) -> Markup:
    score = "" if tried.score is None else f" (safety {percent(tried.score)})"
    return join(f"{tried.note or 'a new text'}: {tried.reason}{score}")


def _case(case: Case, value: LossValue, unfolded: bool) -> Markup:
    outcome = value.result
    body = [el("p", value.error, cls="banner fail")] if value.error else []
    if outcome is not None:
        body += [verdict_facts(outcome), problem_banner(outcome), rule_rows(outcome.specs)]
        body.append(violations(outcome))
    if outcome is None or not any(s.counterexample for s in outcome.specs):
        body.append(listing(value.plan))
    if outcome is not None and unfolded:
        body.append(automaton_section(outcome))
    return el("div", _folded(case.task or "(no task)", join(body), unfolded), cls="card")


def _folded(title: str, content: Markup, unfolded: bool = False) -> Markup:
    return el("details", el("summary", title), content, open="" if unfolded else None)
