"""The rules of a skill on an executed trace, to its end and beyond.

A rule that some prefix of the trace violates is violated, with the step in which that became
certain. What is still open at the end is judged as the model does: the last state goes on for ever.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from pydantic import BaseModel, ConfigDict

from vaso.errors import FormulaError
from vaso.execution import Record
from vaso.ltl import holds, to_english
from vaso.monitoring import RuleStatus, Truth, Watch
from vaso.plan.transition_system import Label
from vaso.platforms import get_platform
from vaso.skill import Rule, Skill

__all__ = ["RuleOutcome", "rules_on"]


class RuleOutcome(BaseModel):
    """What became of a rule in a run.

    Attributes:
        rule: The rule.
        english: The same in words.
        outcome: ``kept``; ``violated``, whatever comes later; ``unfulfilled``, where what it asks
            for has not come about by the end; ``unknown``, where it could not be evaluated.
        step: The step in which it was violated.
        problem: Why it could not be evaluated.
    """

    model_config = ConfigDict(frozen=True)
    rule: str
    english: str = ""
    outcome: Literal["kept", "violated", "unfulfilled", "unknown"]
    step: int | None = None
    problem: str = ""


def rules_on(skill: Skill, records: Sequence[Record]) -> tuple[RuleOutcome, ...]:
    """Evaluate a skill's rules on the states of a run."""
    watch = Watch(skill.rules)
    labels: list[dict[str, Label]] = [dict(record.labels) for record in records]
    for state in labels:
        watch.observe(state)
    phrases = get_platform(skill.platform).phrases
    outcomes = []
    for rule, status in zip(skill.rules, watch.statuses, strict=True):
        found = _outcome(rule, status, labels)
        english = to_english(rule.formula, phrases)
        outcomes.append(found.model_copy(update={"english": english}))
    return tuple(outcomes)


def _outcome(rule: Rule, status: RuleStatus, labels: Sequence[dict[str, Label]]) -> RuleOutcome:
    if status.truth is Truth.VIOLATED:
        return RuleOutcome(rule=rule.text, outcome="violated", step=status.step)
    if status.truth is Truth.SATISFIED:
        return RuleOutcome(rule=rule.text, outcome="kept")
    try:
        is_kept = holds(rule.formula, labels, len(labels) - 1)
    except FormulaError as error:
        return RuleOutcome(rule=rule.text, outcome="unknown", problem=str(error))
    return RuleOutcome(rule=rule.text, outcome="kept" if is_kept else "unfulfilled")
