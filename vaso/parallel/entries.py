"""What a batch is made of: plans with their skills, read once, and their places in the memo."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

from vaso.errors import PlanError, VasoError
from vaso.memo.recall import Recall
from vaso.memo.store import Memo
from vaso.parallel.job import Job
from vaso.parallel.undecided import undecided
from vaso.plan.model import Plan
from vaso.skill import Skill
from vaso.skill_file import load_skill
from vaso.verdict import VerificationResult

__all__ = ["Entry", "Item", "PlanLike", "read_entries"]

PlanLike: TypeAlias = Plan | str | Path
Item: TypeAlias = PlanLike | tuple[Skill | str, PlanLike]


@dataclass(frozen=True)
class Entry:
    """A plan of the batch.

    Attributes:
        job: What to do; None for a plan that cannot be read.
        problem: Why it cannot be read.
        recall: Its place in the memo, if there is a memo.
        undecided: Makes its result where nobody can decide it.
    """

    job: Job | None
    problem: str
    recall: Recall | None
    undecided: Callable[..., VerificationResult]


def read_entries(
    plans: Iterable[Item],
    skill: Skill | str | None,
    options: dict[str, Any],
    check: float,
    memo: Memo | None,
) -> list[Entry]:
    """The plans of a batch, in order.

    Args:
        plans: Plans, or pairs of a skill and a plan.
        skill: The skill of plans without one.
        options: Options of ``verify`` for all of them.
        check: Seconds for model checking one plan.
        memo: The memo, if there is one.

    Raises:
        VasoError: There is no skill, or no such skill. A plan that cannot be read is an entry.
    """
    loaded: dict[str, Skill] = {}

    def skill_of(chosen: Skill | str | None) -> Skill:
        if isinstance(chosen, Skill):
            return chosen
        if chosen is None:
            raise VasoError(
                "the skill is missing", expected="verify_many(plans, skill=...), or pairs of both"
            )
        if chosen not in loaded:
            loaded[chosen] = load_skill(chosen)
        return loaded[chosen]

    entries = []
    for item in plans:
        own, plan = item if isinstance(item, tuple) else (skill, item)
        entries.append(_entry(skill_of(own), plan, options, check, memo))
    return entries


def _entry(
    skill: Skill, plan: PlanLike, options: dict[str, Any], check: float, memo: Memo | None
) -> Entry:
    told = {"specs": options["specs"], "platform": options["platform"]}
    try:
        read = _plan(plan)
    except PlanError as error:
        return Entry(None, str(error), None, partial(undecided, skill, "", **told))
    recall = None if memo is None else Recall(memo, skill, read, options)
    job = Job(skill, read, check, options)
    return Entry(job, "", recall, partial(undecided, skill, read.source, **told))


def _plan(plan: PlanLike) -> Plan:
    if isinstance(plan, Plan):
        return plan
    return Plan.read(plan) if isinstance(plan, Path) else Plan(source=plan)
