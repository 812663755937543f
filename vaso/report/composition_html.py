"""Self-contained HTML about several plans together."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from vaso.concurrency.gradient import JointBlame, joint_blames
from vaso.concurrency.result import CompositionResult, JointCounterexample
from vaso.report.composition import joint_table, members_line
from vaso.report.listing import listing
from vaso.report.markup import Markup, el, join
from vaso.report.page import cell, page
from vaso.report.pieces import problem_banner, rule_rows, verdict_facts
from vaso.verdict import SpecResult

__all__ = ["composition_cell", "composition_html", "joint_counterexample_cell"]


def composition_html(result: CompositionResult) -> str:
    """A page that shows a composition: verdicts, and what the plans can do wrong together."""
    return page("VASO composition", *_parts(result))


def composition_cell(result: CompositionResult) -> str:
    """A composition as the output of a notebook cell."""
    return cell(*_parts(result))


def joint_counterexample_cell(example: JointCounterexample) -> str:
    """A joint counterexample as the output of a notebook cell."""
    head = el("p", "A behaviour that violates ", el("code", example.formula), ":")
    return cell(head, el("div", _timeline(example), cls="card"))


def _parts(result: CompositionResult) -> Iterable[Markup]:
    yield el("h1", "Composition")
    yield verdict_facts(result)
    if result.members:
        yield el("p", str(members_line(result)), cls="soft")
    yield problem_banner(result)
    yield rule_rows(result.specs)
    blames = joint_blames(result)
    if blames:
        yield el("h2", "What the plans can do wrong together")
        found = [s for s in result.specs if isinstance(s.counterexample, JointCounterexample)]
        yield join([_violation(s, result, blames.get(s.spec)) for s in found])
    else:
        yield el("h2", "Plans")
        plans = [(n, text) for m in result.members for n, text in m.plans.items()]
        yield join([join(el("h3", name), listing(text)) for name, text in plans])


def _violation(spec: SpecResult, result: CompositionResult, blame: JointBlame | None) -> Markup:
    example = spec.counterexample
    assert isinstance(example, JointCounterexample)
    told = [el("p", line) for line in (blame.text if blame else "").split("\n") if line]
    plans = [
        join(
            el("h3", f"Plan of {_place(member.name, name)}"),
            listing(text, _marks(blame, member.name, name)),
        )
        for member in result.members
        if member.name in example.members
        for name, text in member.plans.items()
        if text
    ]
    return el(
        "div",
        el("h3", "✗ ", el("code", spec.spec)),
        el("p", f"The rule says: {spec.english}. Together the plans can do this instead:"),
        _timeline(example),
        told,
        plans,
        cls="card",
    )


def _place(member: str, plan: str) -> str:
    return member if member == plan else f"{member}, {plan}"


def _marks(blame: JointBlame | None, member: str, plan: str) -> dict[int, str]:
    return dict.fromkeys(blame.marks.get((member, plan), ()), "") if blame else {}


def _timeline(example: JointCounterexample) -> Markup:
    """One row a step: sensors, what every member does, values, remarks."""
    headings, rows = joint_table(example)
    head = el("tr", [el("th", name, scope="col") for name in headings])
    body = [
        el("tr", [el("td", text, cls=_class(text, violated)) for text in cells])
        for cells, violated in rows
    ]
    table = el("table", el("thead", head), el("tbody", body), cls="timeline")
    return el("div", table, cls="scroll", tabindex=0)


def _class(text: str, violated: bool) -> str | None:
    found: Sequence[str] = [c for c, on in ((text, text in ("yes", "no")), ("bad", violated)) if on]
    return " ".join(found) or None
