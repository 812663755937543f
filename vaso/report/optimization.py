"""An optimization on an HTML page: what it reached and took, its course, its rules and plans."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from vaso.report.listing import diff_block, listing
from vaso.report.markup import Markup, el, join
from vaso.report.pieces import (
    automaton_section,
    badge,
    folded,
    problem_banner,
    rule_rows,
    verdict_facts,
    violations,
)
from vaso.report.run_plots import convergence
from vaso.report.run_rules import rule_history
from vaso.report.run_steps import step_cards
from vaso.report.terminal_runs import count, percent
from vaso.report.trace import seconds

if TYPE_CHECKING:
    from vaso.optimizers.base import Case, LossValue
    from vaso.optimizers.result import OptimizationResult
    from vaso.skill import Skill

READING = (
    "Safety is the share of the rules that the plans keep, task completion the share of what the "
    "first plans could do; both are means over the tasks."
)


def optimization_parts(result: OptimizationResult) -> Iterable[Markup]:
    """The sections of the page."""
    yield from _head(result)
    yield _costs(result)
    yield el("h2", "Convergence")
    yield el("p", READING, cls="soft")
    yield el("div", convergence(result), cls="card")
    yield el("h2", "Rules")
    yield el("p", "Over all tasks: the verdict at the end, and after each step.", cls="soft")
    yield rule_history(result)
    yield _first_violation(result)
    if result.diff:
        yield el("h2", "What changed in the skill")
        yield diff_block(result.diff)
    yield el("h2", "Steps")
    yield step_cards(result)
    yield el("h2", "Plans at the end")
    yield join(
        [_case(c, v, result.skill, n == 0) for n, (c, v) in enumerate(result.values.items())]
    )


def _head(result: OptimizationResult) -> Iterable[Markup]:
    skill = result.initial_skill
    yield el("h1", f"Optimization of {skill.name}")
    if skill.description:
        yield el("p", " ".join(skill.description.split()), cls="soft")
    word = badge("✓ VERIFIED", "pass") if result.verified else badge("✗ NOT VERIFIED", "fail")
    by = f"{count(len(result.values), 'task')}, optimizer {result.optimizer}"
    yield el("div", word, el("span", by), cls="facts")
    if not result.verified:
        kept = "The best version so far is kept." if result.diff else "Nothing better was found."
        style = "banner fail" if result.error else "banner"
        yield el("p", f"{kept} The run stopped because {result.stop_reason}.", cls=style)


def _costs(result: OptimizationResult) -> Markup:
    spent, steps = result.spent, result.steps
    accepted = sum(s.accepted for s in steps)
    turned_down = count(sum(s.tried_count for s in steps), "candidate")
    money = f", ${spent.cost:.4f}" if spent.cost else ""
    tokens = f"{spent.prompt_tokens:,} tokens in, {spent.completion_tokens:,} out{money}"
    tiles = [
        ("Safety", _change(result.safety_before, result.safety), "of the rules are kept"),
        ("Task completion", percent(result.completion), "of what the first plans could do"),
        ("Steps", f"{spent.steps}", f"{accepted} accepted; {turned_down} turned down"),
        ("Loss calls", f"{spent.loss_calls}", f"and {spent.memo_hits} answered from memory"),
        ("Model calls", f"{spent.lm_calls}", tokens if spent.lm_calls else "no language model"),
        ("Time", _duration(spent.seconds), "in all"),
    ]
    return el("div", [_tile(*tile) for tile in tiles], cls="tiles")


def _tile(name: str, value: str, remark: str) -> Markup:
    lines = ((name, "name"), (value, "figure"), (remark, "soft"))
    return el("div", [el("div", text, cls=cls) for text, cls in lines])


def _change(before: float, after: float) -> str:
    return percent(after) if before == after else f"{percent(before)} →\u00a0{percent(after)}"


def _duration(value: float) -> str:
    minutes, rest = divmod(round(value), 60)
    return seconds(value) if value < 60 else f"{minutes} min {rest} s"


def _first_violation(result: OptimizationResult) -> Markup:
    """What was wrong with the skill at the start: the first task whose plan violates a rule."""
    for case, value in result.before.items():
        found = value.result
        if found is not None and any(s.counterexample for s in found.specs):
            told = el("p", "Task: ", el("em", case.task or "(no task)"), cls="soft")
            shown = violations(found, result.initial_skill, most=1)
            return join(el("h2", "What was wrong at the start"), told, shown)
    return Markup()


def _case(case: Case, value: LossValue, skill: Skill, unfolded: bool) -> Markup:
    outcome = value.result
    body = [el("p", value.error, cls="banner fail")] if value.error else []
    if outcome is not None:
        body += [verdict_facts(outcome), problem_banner(outcome)]
        rules = folded("The verdict on each rule", rule_rows(outcome.specs), unfolded=not outcome)
        body += [rules, violations(outcome, skill)] if outcome.specs else []
    if value.plan and (outcome is None or not any(s.counterexample for s in outcome.specs)):
        body.append(listing(value.plan))
    if outcome is not None and unfolded:
        body.append(automaton_section(outcome))
    content = folded(case.task or "(no task)", join(body), unfolded=unfolded)
    return el("div", content, cls="case")
