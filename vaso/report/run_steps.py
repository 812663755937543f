"""The steps of an optimization: what changed, why, and what was tried in vain."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import groupby
from typing import TYPE_CHECKING

from vaso.report.listing import diff_block, difference
from vaso.report.markup import Markup, el, join
from vaso.report.pieces import badge, folded, prose
from vaso.report.terminal_runs import count, percent

if TYPE_CHECKING:
    from vaso.optimizers.result import OptimizationResult, StepRecord, Tried

SHORT = 16
NAMES = {
    "local_rule": "Local rule",
    "labelling_code": "Labelling code",
    "plan_template": "Plan template",
}


def step_cards(result: OptimizationResult) -> Markup:
    """A card for each step."""
    texts: Mapping[str, str] = dict(result.initial)
    safety, violated = result.safety_before, result.violated_before
    cards = []
    for step in result.steps:
        alone = step.diff == result.diff
        short = len(step.gradient.splitlines()) <= SHORT
        there = [rule for rule in violated if rule not in _replaced(texts, step)]
        cards.append(step_card(step, texts, safety, there, unfolded=short, repeated=alone))
        texts, safety, violated = step.texts or texts, step.safety, step.violated
    return join(cards) or el("p", "No step was needed.", cls="soft")


def _replaced(texts: Mapping[str, str], step: StepRecord) -> set[str]:
    """Local rules that a step took away."""
    before, after = (t.get("local_rule", "").splitlines() for t in (texts, step.texts or texts))
    return {line.strip() for line in before} - {line.strip() for line in after}


def step_card(
    step: StepRecord,
    texts: Mapping[str, str] | None = None,
    before: float | None = None,
    violated: Iterable[str] = (),
    *,
    unfolded: bool = True,
    repeated: bool = False,
) -> Markup:
    """A step: accepted or not, its diff, the gradient it worked from, what was turned down.

    Args:
        step: The step.
        texts: The texts before it, to show what a candidate would have changed.
        before: Safety before it.
        violated: Rules that were violated before it.
        unfolded: Show the gradient at once.
        repeated: Fold the diff, because the page shows it already.
    """
    word = badge("✓ accepted", "pass") if step.accepted else badge("✗ nothing accepted", "fail")
    change = percent(step.safety)
    if before is not None and step.safety != before:
        change = f"{percent(before)} → {change}"
    diff = diff_block(step.diff) if step.diff else None
    return el(
        "div",
        el("h3", f"Step {step.step} ", word, el("span", f" safety {change}", cls="plain")),
        el("p", prose(step.note)) if step.note else None,
        el("p", step.error, cls="banner fail") if step.error else None,
        _rules("Now kept:", [r for r in violated if r not in step.violated]),
        folded("What changed", diff) if diff and repeated else diff,
        _rules("Still violated:", step.violated),
        _gradient(step, unfolded),
        _tried(step, texts or {}) if step.tried else None,
        cls="card step",
    )


def _rules(title: str, rules: Iterable[str]) -> Markup | None:
    items = [el("li", el("code", rule)) for rule in rules]
    return join(el("p", title, cls="small"), el("ul", items)) if items else None


def _gradient(step: StepRecord, unfolded: bool) -> Markup | None:
    if not step.gradient:
        return None
    return folded("Textual gradient", gradient_block(step.gradient), unfolded=unfolded)


def gradient_block(text: str) -> Markup:
    """Feedback as it is given to an optimizer: sentences wrap, tables and code do not."""
    parts: list[Markup] = []
    for fixed, lines in groupby(text.splitlines(), _is_laid_out):
        block = "\n".join(lines).strip("\n")
        if block and fixed:
            parts.append(el("div", el("pre", block), cls="scroll", tabindex=0))
        elif block:
            parts.append(el("p", block, cls="said"))
    return el("div", parts, cls="gradient")


def _is_laid_out(line: str) -> bool:
    """True for a line of a table or of code."""
    return "  " in line or line.startswith(("…", "↺"))


def _tried(step: StepRecord, texts: Mapping[str, str]) -> Markup:
    title = f"{count(step.tried_count, 'candidate')} turned down"
    missing = step.tried_count - len(step.tried)
    more = el("p", f"The last {len(step.tried)} of them:", cls="soft small") if missing else None
    return folded(title, join(more, [_attempt(t, texts) for t in step.tried]))


def _attempt(tried: Tried, texts: Mapping[str, str]) -> Markup:
    said = tried.score is None or "safety" in tried.reason
    score = "" if said else f" (safety {percent(tried.score or 0.0)})"
    told = prose(f"{tried.note or 'a new text'}: {tried.reason}{score}")
    line = join(el("span", "✗ ", cls="fail"), told)
    changes = [
        join(el("p", NAMES.get(name, name), cls="small"), difference(texts.get(name, ""), text))
        for name, text in tried.texts.items()
        if texts
    ]
    content = folded(line, join(changes)) if changes else el("p", line)
    return el("div", content, cls="attempt")
