"""Self-contained HTML pages about a skill, a verification and an optimization.

A page is one file: styles and drawings inside, no script, nothing fetched. It also serves as the
``_repr_html_`` of the object in a notebook.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from vaso.plan.transition_system import TransitionSystem
from vaso.report.listing import listing
from vaso.report.markup import Markup, el, join
from vaso.report.page import page
from vaso.report.pieces import (
    automaton_section,
    drawing,
    problem_banner,
    problem_line,
    rule_rows,
    verdict_facts,
    violations,
)
from vaso.skill import Rule, Skill
from vaso.verdict import VerificationResult

if TYPE_CHECKING:
    from vaso.optimizers.result import OptimizationResult


def skill_html(skill: Skill) -> str:
    """A page that shows a skill: its rules with their reading in English, its code."""
    head = [
        el("h1", skill.name),
        el("p", skill.description or None),
        el("p", f"platform: {skill.platform}", cls="soft"),
    ]
    return page(f"VASO skill {skill.name}", head, *_contracts(skill))


def _contracts(skill: Skill) -> Iterable[Markup]:
    groups = [
        ("Global contract", "Every skill of this robot keeps these rules.", skill.global_rules),
        ("Local contract", "What this skill is for.", skill.local_rules),
        ("Assumptions", "What the surroundings are trusted to do.", skill.assumptions),
    ]
    for title, meaning, rules in groups:
        if rules:
            yield el("h2", title)
            yield el("p", meaning, cls="soft")
            yield el("div", [_rule(r, skill) for r in rules], cls="card")
    for title, code in (
        ("Proposition-aligned APIs", skill.labelling_code),
        ("Plan template", skill.plan_template),
    ):
        yield el("h2", title)
        yield listing(code)


def _rule(rule: Rule, skill: Skill) -> Markup:
    return el("p", el("code", rule.text), el("br"), el("span", english(rule, skill), cls="soft"))


def english(rule: Rule, skill: Skill) -> str:
    """A rule in plain English, in the words of the skill's platform."""
    from vaso.errors import PlatformError
    from vaso.ltl import to_english
    from vaso.platforms import get_platform

    try:
        phrases = get_platform(skill.platform).phrases
    except PlatformError:
        phrases = {}
    return to_english(rule.formula, phrases)


def verification_html(result: VerificationResult) -> str:
    """A page that shows a verification: verdicts, counterexamples over time, plan, automaton."""
    return page(
        "VASO verification",
        el("h1", "Verification"),
        verdict_facts(result),
        problem_banner(result),
        rule_rows(result.specs),
        violations(result),
        _plan(result),
        automaton_section(result),
    )


def _plan(result: VerificationResult) -> Markup:
    if any(s.counterexample for s in result.specs):
        return Markup()
    return join(el("h2", "Plan"), listing(result.plan, problem_line(result)))


def plan_html(system: TransitionSystem) -> str:
    """A page that shows a plan and what it can do."""
    title = "What the plan can do"
    return page(title, el("h1", title), listing(system.source), drawing(system))


def optimization_html(result: OptimizationResult) -> str:
    """A page that shows an optimization: convergence, steps, gradients, diffs, rules, plans."""
    from vaso.report.optimization import optimization_parts

    name = result.initial_skill.name
    return page(f"VASO optimization of {name}", *optimization_parts(result))
