"""The building blocks of the HTML pages about verification."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from vaso.plan.transition_system import TransitionSystem
from vaso.report.graph import automaton_svg
from vaso.report.labels import label_banner
from vaso.report.listing import listing
from vaso.report.markup import Child, Markup, el, join
from vaso.report.terminal import remarks
from vaso.report.timeline import timeline
from vaso.report.trace import blame_of, marks_of, seconds
from vaso.verdict import SpecResult, Verdict, VerificationResult

if TYPE_CHECKING:
    from vaso.gradient.blame import Blame
    from vaso.skill import Skill

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


def prose(text: str) -> Markup:
    """A sentence in which `` `code` `` is set as code."""
    parts = text.split("`")
    if len(parts) % 2 == 0:
        return join(text)
    return join([el("code", p) if n % 2 else join(p) for n, p in enumerate(parts)])


def folded(title: Child, content: Child, *, unfolded: bool = False) -> Markup:
    """Content that shows when its title is clicked."""
    return el("details", el("summary", title), content, open="" if unfolded else None)


def verdict_facts(result: VerificationResult) -> Markup:
    """Verdict, rules kept, size of the automaton and time in one line."""
    kept = sum(bool(s.verdict) for s in result.specs)
    facts = [f"{kept} of {len(result.specs)} rules hold"] if result.specs else []
    if result.states:
        facts.append(f"{result.states} states, {result.transitions} transitions")
    facts.append(seconds(result.seconds))
    bad = result.problem is not None and result.problem.kind == "input"
    word = badge("✗ CANNOT BE VERIFIED", "fail") if bad else verdict_badge(result.verdict)
    return el("div", word, [el("span", f) for f in facts], cls="facts")


def problem_banner(result: VerificationResult) -> Markup:
    """What kept the plan from being verified, and what its author should know."""
    problem = result.problem
    first = [el("p", problem.message, cls="banner fail")] if problem else []
    return join(first, label_banner(result), [el("p", w, cls="banner") for w in result.warnings])


def rule_rows(specs: Sequence[SpecResult]) -> Markup:
    """One row a rule: verdict, formula, reading in English, what the verdict rests on, time."""
    return el("div", [_spec_row(s) for s in specs], cls="card rules") if specs else Markup()


def rule_text(rule: str, english: str, role: str = "") -> Markup:
    """A rule as it is written, where it comes from, and its reading in English."""
    tag = el("span", role, cls="tag") if role else None
    return join(el("p", el("code", rule), tag), el("p", english, cls="soft") if english else None)


def rule_remark(label: str, text: str) -> Markup:
    """What to know about the verdict on a rule."""
    return el("p", el("strong", f"{label}: "), text, cls="small")


def _spec_row(spec: SpecResult) -> Markup:
    told = [rule_remark(label, text) for label, text in remarks(spec)]
    text = el("div", rule_text(spec.spec, spec.english, spec.role), told)
    took = el("span", seconds(spec.seconds), cls="soft small")
    return el("div", el("div", verdict_badge(spec.verdict)), text, took, cls="rule")


def violations(
    result: VerificationResult, skill: Skill | None = None, *, most: int | None = None
) -> Markup:
    """For each violated rule, a behaviour of the plan that violates it, and the lines to blame.

    Args:
        result: The result.
        skill: The skill that was verified, if it is known.
        most: After so many, the others are folded.
    """
    blames = blame_of(result, skill)
    found = [_violation(s, result, blames.get(s.formula)) for s in result.specs if s.counterexample]
    rest = found[most:] if most is not None else []
    title = f"{len(rest)} more: what else the plan can do wrong"
    return join(found[:most], folded(title, join(rest)) if rest else None)


def _violation(spec: SpecResult, result: VerificationResult, blame: Blame | None) -> Markup:
    assert spec.counterexample is not None
    faded = result.coverage.never if result.coverage else ()
    return el(
        "div",
        el("h3", "✗ ", el("code", spec.spec)),
        el("p", f"The rule says: {spec.english}. The plan can do this instead:"),
        timeline(spec.counterexample),
        el("p", prose(blame.text)) if blame and blame.text else None,
        listing(result.plan, marks_of(blame), faded),
        cls="card",
    )


def problem_line(result: VerificationResult) -> dict[int, str]:
    """The plan line of a problem, to be marked."""
    problem = result.problem
    return {problem.line: "here"} if problem and problem.line else {}


def automaton_section(result: VerificationResult) -> Markup:
    """The drawing of the plan's automaton, if there is one, with the first counterexample in it."""
    if result.system is None:
        return Markup()
    shown = next((s for s in result.specs if s.counterexample), None)
    if shown is None or shown.counterexample is None:
        return drawing(result.system)
    steps = shown.counterexample.steps
    behaviour = [s.state for s in (*steps, steps[shown.counterexample.loop_start])]
    told = el("p", "In red: the behaviour that violates ", el("code", shown.spec), ".")
    return drawing(result.system, behaviour, told)


def drawing(
    system: TransitionSystem, behaviour: Sequence[int] = (), told: Markup | None = None
) -> Markup:
    """An automaton with a word on how to read it."""
    meaning = (
        f"All that the plan can do, one step every {system.dt:g} s. A box is a command that the "
        "robot executes, an arrow leads to the next; “if” says which sensor readings lead there."
    )
    card = el("div", automaton_svg(system, behaviour), cls="card")
    return join(el("h2", "Automaton"), el("p", meaning, cls="soft"), told, card)
