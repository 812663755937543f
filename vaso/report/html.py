"""Self-contained HTML pages about a skill, a verification and an optimization.

A page is one file: styles and drawings inside, no script, nothing fetched. It also serves as the
``_repr_html_`` of the object in a notebook.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from vaso.report.graph import automaton_svg
from vaso.report.listing import listing
from vaso.report.markup import Markup, el, join
from vaso.report.page import page
from vaso.report.timeline import timeline
from vaso.report.trace import blamed_lines, seconds
from vaso.skill import Rule, Skill
from vaso.verdict import SpecResult, Verdict, VerificationResult

SYMBOLS = {
    Verdict.PASS: "✓ PASS",
    Verdict.FAIL: "✗ FAIL",
    Verdict.UNKNOWN: "? UNKNOWN",
    Verdict.UNSUPPORTED: "– UNSUPPORTED",
}


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
        el("h2", "Plan"),
        listing(result.plan, _marks(result)),
        automaton_section(result),
    )


def badge(text: str, kind: str = "") -> Markup:
    """A small coloured label; ``kind`` is ``pass``, ``fail`` or empty."""
    return el("span", text, cls=f"badge {kind}".strip())


def verdict_badge(verdict: Verdict) -> Markup:
    """The label of a verdict."""
    kind = verdict.value if verdict in (Verdict.PASS, Verdict.FAIL) else ""
    return badge(SYMBOLS[verdict], kind)


def verdict_facts(result: VerificationResult) -> Markup:
    """Verdict, rules kept, size of the automaton and time in one line."""
    kept = sum(bool(s.verdict) for s in result.specs)
    facts = [f"{kept} of {len(result.specs)} rules hold"] if result.specs else []
    if result.states:
        facts.append(f"{result.states} states, {result.transitions} transitions")
    facts.append(seconds(result.seconds))
    return el("div", verdict_badge(result.verdict), [el("span", f) for f in facts], cls="facts")


def problem_banner(result: VerificationResult) -> Markup:
    """What kept the plan from being verified, and what its author should know."""
    problem = result.problem
    first = [el("p", problem.message, cls="banner fail")] if problem else []
    return join(first, [el("p", w, cls="banner") for w in result.warnings])


def rule_rows(specs: Sequence[SpecResult]) -> Markup:
    """One row a rule: verdict, formula, reading in English, what the verdict rests on, time."""
    return el("div", [_spec_row(s) for s in specs], cls="card") if specs else Markup()


def _spec_row(spec: SpecResult) -> Markup:
    remarks = [("assuming ", a) for a in spec.assumptions]
    remarks += [("vacuous: ", spec.vacuous)] if spec.vacuous else []
    remarks += [("why: ", spec.reason)] if spec.reason else []
    remarks += [("note: ", w) for w in spec.warnings]
    text = [
        el("p", el("code", spec.spec)),
        el("p", spec.english, cls="soft"),
        *(el("p", el("strong", label), remark, cls="small") for label, remark in remarks),
    ]
    took = el("span", seconds(spec.seconds), cls="soft small")
    return el("div", el("div", verdict_badge(spec.verdict)), el("div", text), took, cls="rule")


def violations(result: VerificationResult) -> Markup:
    """For each violated rule, a behaviour of the plan that violates it."""
    return join([_violation(s) for s in result.specs if s.counterexample])


def _violation(spec: SpecResult) -> Markup:
    assert spec.counterexample is not None
    return el(
        "div",
        el("h3", "✗ ", el("code", spec.spec)),
        el("p", f"The rule says: {spec.english}. The plan can do this instead:"),
        timeline(spec.counterexample),
        cls="card",
    )


def _marks(result: VerificationResult) -> dict[int, str]:
    problem = result.problem
    marks = {problem.line: "here"} if problem and problem.line else {}
    for spec in result.specs:
        if spec.counterexample:
            marks |= blamed_lines(spec.counterexample)
    return marks


def automaton_section(result: VerificationResult) -> Markup:
    """The drawing of the plan's automaton, if there is one."""
    if result.system is None:
        return Markup()
    return join(
        el("h2", "Automaton"),
        el(
            "p",
            f"What the plan can do, one step every {result.system.dt:g} s. A box is a command; "
            "“if” says which sensor readings lead to it.",
            cls="soft",
        ),
        automaton_svg(result.system),
    )
