"""The rules of a skill over an optimization: which are kept, before and after each step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from vaso.report.markup import Markup, el, join
from vaso.report.pieces import badge, rule_remark, rule_text, verdict_badge
from vaso.report.terminal import remarks
from vaso.report.terminal_runs import count
from vaso.verdict import SpecResult, Verdict

if TYPE_CHECKING:
    from vaso.optimizers.base import Case, LossValue
    from vaso.optimizers.result import OptimizationResult

ORDER = (Verdict.FAIL, Verdict.UNSUPPORTED, Verdict.UNKNOWN, Verdict.PASS)
MOST = 12
KEPT, VIOLATED, OPEN, ABSENT = "✓", "✗", "?", "–"
MEANING = {
    KEPT: ("pass", "kept on every task"),
    VIOLATED: ("fail", "not kept on every task"),
    OPEN: ("", "not known"),
    ABSENT: ("absent", "not a rule of the skill then"),
}


@dataclass(frozen=True, slots=True)
class Moment:
    """How the rules stand at the start, or after a step.

    Attributes:
        name: ``start`` or the number of the step.
        rules: The rules of the skill then.
        violated: Those that some plan does not keep.
        decided: False where it is not known of every rule on every task.
    """

    name: str
    rules: frozenset[str]
    violated: frozenset[str]
    decided: bool = True

    def mark(self, rule: str) -> str:
        """Whether a rule is kept."""
        if rule not in self.rules:
            return ABSENT
        return VIOLATED if rule in self.violated else KEPT if self.decided else OPEN


def rule_history(result: OptimizationResult) -> Markup:
    """A row a rule: its verdict at the end over all tasks, its reading, and how it stood before."""
    moments = _chosen(_moments(result))
    found = _verdicts(result.values)
    now = dict.fromkeys([*(r.text for r in result.skill.rules), *found])
    tasks = len(result.values)
    rows = [_row(rule, found.get(rule, []), moments, tasks) for rule in now]
    former = dict.fromkeys(r.text for r in result.initial_skill.rules if r.text not in now)
    rows += [_former_row(rule, moments) for rule in former]
    return el("div", rows, cls="card rules") if rows else Markup()


def _moments(result: OptimizationResult) -> list[Moment]:
    fixed = [r.text for r in result.initial_skill.global_rules]
    local = [r.text for r in result.initial_skill.local_rules]
    found = [_moment("start", fixed + local, result.violated_before, result.safety_before)]
    for step in result.steps:
        if "local_rule" in step.texts:
            local = [line.strip() for line in step.texts["local_rule"].splitlines() if line.strip()]
        found.append(_moment(str(step.step), fixed + local, step.violated, step.safety))
    return found


def _moment(name: str, rules: list[str], violated: Sequence[str], safety: float) -> Moment:
    """How the rules stand; a task without any verdict shows in a safety that is too low."""
    least = 1 - len(set(violated)) / max(1, len(rules))
    return Moment(name, frozenset(rules), frozenset(violated), safety >= least - 1e-9)


def _chosen(moments: list[Moment]) -> list[Moment]:
    """The start, the end, and of many only those that differ from the one before."""
    if len(moments) <= MOST:
        return moments
    changes = [b for a, b in pairwise(moments) if (a.rules, a.violated) != (b.rules, b.violated)]
    return list(dict.fromkeys([moments[0], *changes, moments[-1]]))


def _verdicts(values: Mapping[Case, LossValue]) -> dict[str, list[SpecResult]]:
    found: dict[str, list[SpecResult]] = {}
    for value in values.values():
        for spec in value.result.specs if value.result is not None else ():
            found.setdefault(spec.spec, []).append(spec)
    return found


def _row(rule: str, found: list[SpecResult], moments: list[Moment], tasks: int) -> Markup:
    kept = f"{sum(bool(s.verdict) for s in found)} of {count(tasks, 'task')}"
    told = el("div", kept, cls="soft small") if tasks > 1 else None
    word, text = verdict_badge(_worst(found, tasks)), _told(rule, found)
    end = el("div", _chips(rule, moments), told, cls="end")
    return el("div", el("div", word), el("div", text), end, cls="rule")


def _former_row(rule: str, moments: list[Moment]) -> Markup:
    """A row for a local rule that was replaced."""
    word, end = badge("– REPLACED"), el("div", _chips(rule, moments), cls="end")
    return el("div", el("div", word), el("div", rule_text(rule, "")), end, cls="rule")


def _worst(found: list[SpecResult], tasks: int) -> Verdict:
    """The worst verdict over the tasks; a task without one makes it unknown at best."""
    verdicts = {s.verdict for s in found}
    verdicts |= {Verdict.UNKNOWN} if len(found) < tasks or not found else set()
    return next(v for v in ORDER if v in verdicts)


def _told(rule: str, found: list[SpecResult]) -> Markup:
    """The rule, its reading, and what its verdicts rest on."""
    told = dict.fromkeys(remark for spec in found for remark in remarks(spec))
    english, role = (found[0].english, found[0].role) if found else ("", "")
    return join(rule_text(rule, english, role), [rule_remark(*r) for r in told])


def _chips(rule: str, moments: list[Moment]) -> Markup:
    return el("div", [_chip(m.name, m.mark(rule)) for m in moments], cls="chips")


def _chip(name: str, mark: str) -> Markup:
    kind, meaning = MEANING[mark]
    told = f"{'at the start' if name == 'start' else f'after step {name}'}: {meaning}"
    return el("span", el("span", name, cls="when"), mark, cls=f"chip {kind}".strip(), title=told)
