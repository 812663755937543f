"""Self-contained HTML pages about a skill, a verification and an optimization.

A page is one file: styles and drawings inside, no script, nothing fetched. What it contains also
serves as the output of a notebook cell, see :mod:`vaso.report.cells`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from vaso.plan.transition_system import TransitionSystem
from vaso.report.between import between_section
from vaso.report.coverage import coverage_section
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
    return page(f"VASO skill {skill.name}", *skill_parts(skill))


def verification_html(result: VerificationResult) -> str:
    """A page that shows a verification: verdicts, counterexamples over time, plan, automaton."""
    return page("VASO verification", *verification_parts(result))


def plan_html(system: TransitionSystem) -> str:
    """A page that shows a plan and what it can do."""
    return page("What the plan can do", *plan_parts(system))


def optimization_html(result: OptimizationResult) -> str:
    """A page that shows an optimization: convergence, steps, gradients, diffs, rules, plans."""
    from vaso.report.optimization import optimization_parts

    name = result.initial_skill.name
    return page(f"VASO optimization of {name}", *optimization_parts(result))


def skill_parts(skill: Skill) -> Iterable[Markup]:
    """What a page about a skill contains."""
    yield el("h1", skill.name)
    if skill.description:
        yield el("p", skill.description)
    yield el("p", f"platform: {skill.platform}", cls="soft")
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


def verification_parts(result: VerificationResult) -> Iterable[Markup]:
    """What a page about a verification contains."""
    yield el("h1", "Verification")
    yield verdict_facts(result)
    yield problem_banner(result)
    yield rule_rows(result.specs)
    yield between_section(result.between)
    yield coverage_section(result.coverage)
    if any(s.counterexample for s in result.specs):
        yield el("h2", "What the plan can do wrong")
        yield violations(result)
    else:
        faded = result.coverage.never if result.coverage else ()
        yield join(el("h2", "Plan"), listing(result.plan, problem_line(result), faded))
    yield automaton_section(result)


def plan_parts(system: TransitionSystem) -> Iterable[Markup]:
    """What a page about an automaton contains."""
    size = f"{len(system.states)} states, {system.transitions} transitions"
    yield el("h1", "What the plan can do")
    yield el("p", size, cls="soft")
    if system.cut:
        yield el("p", f"Not explored further: {system.cut.reason}", cls="banner")
    yield from (el("p", w, cls="banner") for w in system.warnings)
    yield listing(system.source) if system.source else Markup()
    yield drawing(system)
