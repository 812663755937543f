"""The building blocks of the HTML pages about verification."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from vaso.plan.transition_system import TransitionSystem
from vaso.report.graph import automaton_svg
from vaso.report.listing import listing
from vaso.report.markup import Markup, el, join
from vaso.report.timeline import timeline
from vaso.report.trace import blame_of, marks_of, seconds
from vaso.verdict import SpecResult, Verdict, VerificationResult

if TYPE_CHECKING:
    from vaso.gradient.blame import Blame

SYMBOLS = {
    Verdict.PASS: "✓ PASS",
    Verdict.FAIL: "✗ FAIL",
    Verdict.UNKNOWN: "? UNKNOWN",
    Verdict.UNSUPPORTED: "– UNSUPPORTED",
}


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
    """For each violated rule, a behaviour of the plan that violates it, and the lines to blame."""
    blames = blame_of(result)
    return join(
        [
            _violation(s, result.plan, blames.get(s.formula))
            for s in result.specs
            if s.counterexample
        ]
    )


def _violation(spec: SpecResult, plan: str, blame: Blame | None) -> Markup:
    assert spec.counterexample is not None
    return el(
        "div",
        el("h3", "✗ ", el("code", spec.spec)),
        el("p", f"The rule says: {spec.english}. The plan can do this instead:"),
        timeline(spec.counterexample),
        el("p", blame.text) if blame and blame.text else None,
        listing(plan, marks_of(blame)),
        cls="card",
    )


def problem_line(result: VerificationResult) -> dict[int, str]:
    """The plan line of a problem, to be marked."""
    problem = result.problem
    return {problem.line: "here"} if problem and problem.line else {}


def automaton_section(result: VerificationResult) -> Markup:
    """The drawing of the plan's automaton, if there is one."""
    return Markup() if result.system is None else drawing(result.system)


def drawing(system: TransitionSystem) -> Markup:
    """An automaton with a word on how to read it."""
    meaning = (
        f"What the plan can do, one step every {system.dt:g} s. A box is a command; “if” says "
        "which sensor readings lead to it."
    )
    return join(el("h2", "Automaton"), el("p", meaning, cls="soft"), automaton_svg(system))
