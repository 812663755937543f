"""The plans that a :class:`~vaso.modules.SkillProgram` tries for one task, and what comes next."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import dspy

from vaso.errors import SkillError
from vaso.gradient.model import Level
from vaso.modules.symbolic import SymbolicPlanner
from vaso.plan.model import Plan
from vaso.skill import Skill
from vaso.verdict import VerificationResult

if TYPE_CHECKING:
    from vaso.modules.skill_program import SkillProgram

PlannerLike = Callable[..., Any]
"""Called with a skill and a task; gives a :class:`~vaso.plan.Plan`, its text, or a
``dspy.Prediction`` with one in its field ``plan``. It may take ``feedback``."""


def level_of(level: Level | str) -> Level:
    """A level of feedback by name.

    Raises:
        SkillError: There is none of that name.
    """
    try:
        return Level(level)
    except ValueError:
        raise SkillError(f"there is no level '{level}'", expected=", ".join(Level)) from None


def count_of(attempts: int) -> int:
    """A number of attempts.

    Raises:
        SkillError: It is no whole number from 1 on.
    """
    if isinstance(attempts, bool) or not isinstance(attempts, int) or attempts < 1:
        raise SkillError(f"{attempts!r} attempts cannot be made", expected="1 or more")
    return attempts


@dataclass(frozen=True)
class Attempt:
    """One plan that was tried.

    Attributes:
        plan: The plan.
        result: Its verification, without the automaton, which may be large.
        feedback: The textual gradient.
    """

    plan: Plan
    result: VerificationResult
    feedback: str

    @property
    def rank(self) -> tuple[bool, float]:
        """Verified before safer before less safe; greater is better."""
        return bool(self.result), self.result.safety


class Search:
    """Plans for one task, tried one after the other.

    Attributes:
        skill: The skill that plans are written with.
        task: The task prompt.
        tried: The plans so far.
    """

    def __init__(
        self, program: SkillProgram, task: Any, feedback: str = "", skill: Skill | None = None
    ) -> None:
        self.skill = skill or program.skill
        self.task = str(getattr(task, "prompt", task))
        self.tried: list[Attempt] = []
        self._program, self._planner = program, program.planner
        self._hint = feedback
        self._traces: list[list[Any]] = []
        self._takes_feedback = takes_feedback(program.planner)

    # -- how it goes on --------------------------------------------------------------------------

    def add(self, attempt: Attempt, trace: list[Any]) -> None:
        """Note a plan, with the calls of predictors that led to it."""
        self.tried.append(attempt)
        self._traces.append(trace)

    @property
    def over(self) -> bool:
        """True when a plan is verified, the budget is spent, or nothing new can come."""
        if not self.tried:
            return False
        spent = len(self.tried) >= self._program.attempts
        fixed = isinstance(self._planner, SymbolicPlanner)
        return bool(self.tried[-1].result) or spent or fixed or self._stuck

    @property
    def _stuck(self) -> bool:
        """A function that is not told what was wrong has given the same plan again."""
        function = self._planner is not None and not isinstance(self._planner, dspy.Module)
        return function and not self._takes_feedback and self._repeats > 0

    @property
    def _repeats(self) -> int:
        return len(self.tried) - len({a.plan.source for a in self.tried})

    # -- the next plan ---------------------------------------------------------------------------

    @property
    def _last(self) -> tuple[str, str]:
        """The last plan and what was wrong with it, as far as the planner is to know."""
        if self.tried and self._program.strategy == "feedback":
            return self.tried[-1].plan.source, self.tried[-1].feedback
        return "", self._hint

    def inputs(self) -> dict[str, str]:
        """The fields of the program's own predictor."""
        fields: dict[str, str] = self._program.write.inputs(self.skill, self.task, *self._last)
        return fields

    def arguments(self) -> tuple[tuple[Skill, str], dict[str, str]]:
        """Arguments of a planner. A module that does not take ``feedback`` reads it in the task."""
        previous, feedback = self._last
        if not feedback:
            return (self.skill, self.task), {}
        if self._takes_feedback:
            return (self.skill, self.task), {"feedback": feedback}
        if not isinstance(self._planner, dspy.Module):
            return (self.skill, self.task), {}
        told = f"The previous plan:\n{previous}\n\nWhat is wrong with it:\n" if previous else ""
        return (self.skill, f"{self.task}\n\n{told}{feedback}"), {}

    def model(self, lm: Any) -> Any:
        """The model for the next plan, with a rollout of its own where a cache would repeat one.

        Args:
            lm: The model in use, or None.
        """
        fresh = self._repeats if self._program.strategy == "feedback" else len(self.tried)
        if lm is None or not fresh:
            return lm
        start = lm.kwargs.get("rollout_id") or 0
        return lm.copy(rollout_id=start + len(self.tried), temperature=1.0)

    # -- the outcome -----------------------------------------------------------------------------

    def prediction(self) -> dspy.Prediction:
        """The best plan, with all that is known about it.

        Only the calls that led to it go into dspy's trace: a refuted plan is no demonstration.
        """
        number = max(range(len(self.tried)), key=lambda i: self.tried[i].rank)
        best = self.tried[number]
        if dspy.settings.trace is not None:
            dspy.settings.trace.extend(self._traces[number])
        examples = [s.counterexample for s in best.result.failures if s.counterexample is not None]
        return dspy.Prediction(
            plan=best.plan,
            source=best.plan.source,
            task=self.task,
            skill=self.skill,
            verified=bool(best.result),
            verdict=best.result.verdict,
            result=best.result,
            counterexample=next(iter(examples), None),
            feedback=best.feedback,
            attempts=tuple(self.tried),
        )


@contextmanager
def tracing() -> Iterator[list[Any]]:
    """Collect the calls of predictors apart, where dspy traces them at all."""
    if dspy.settings.trace is None:
        yield []
        return
    steps: list[Any] = []
    with dspy.context(trace=steps):
        yield steps


def plan_of(answer: Any, task: str) -> Plan:
    """The plan in a planner's answer, for the task as the user gave it.

    Raises:
        SkillError: There is none.
    """
    found = getattr(answer, "plan", answer)
    if isinstance(found, Plan):
        return found.model_copy(update={"task": task})
    if isinstance(found, str):
        return Plan(source=found, task=task)
    raise SkillError(
        f"the planner gave {type(answer).__name__}, which is no plan",
        expected="a vaso.Plan, its text, or a dspy.Prediction with a field 'plan'",
    )


def takes_feedback(planner: Any) -> bool:
    """True for a planner with a parameter ``feedback``."""
    function = type(planner).forward if isinstance(planner, dspy.Module) else planner
    try:
        return "feedback" in inspect.signature(function).parameters
    except (TypeError, ValueError):
        return False
