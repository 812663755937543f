"""The result of an optimization."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel, ConfigDict

from vaso.optimizers.base import Case, LossValue
from vaso.optimizers.budget import Spent
from vaso.optimizers.parameters import Parameters
from vaso.skill import Skill
from vaso.verdict import VerificationResult


class Tried(BaseModel):
    """A candidate that was turned down.

    Attributes:
        note: How it came about.
        reason: Why it was turned down.
        score: Its mean safety, where it was evaluated.
        texts: The texts that it would have changed.
    """

    model_config = ConfigDict(frozen=True)
    note: str = ""
    reason: str = ""
    score: float | None = None
    texts: dict[str, str] = {}


class StepRecord(BaseModel):
    """One optimization step.

    Attributes:
        step: Its number, from 1.
        accepted: True if the texts changed.
        safety: Mean safety after the step.
        completion: Mean task completion after the step.
        violated: Rules that are still violated after the step.
        gradient: The textual gradient that the step worked from.
        note: How the accepted candidate came about.
        diff: The accepted change of the texts.
        texts: All texts after an accepted step; empty after any other.
        tried: The last candidates that were turned down.
        tried_count: How many were turned down.
        error: Why the step failed, where a proposer or a model did.
        loss_calls: Loss calls since the start of the run, this step's among them.
    """

    model_config = ConfigDict(frozen=True)
    step: int
    accepted: bool
    safety: float
    completion: float
    violated: tuple[str, ...] = ()
    gradient: str = ""
    note: str = ""
    diff: str = ""
    texts: dict[str, str] = {}
    tried: tuple[Tried, ...] = ()
    tried_count: int = 0
    error: str = ""
    loss_calls: int = 0

    def _repr_html_(self) -> str:
        from vaso.report.cells import step_cell

        return step_cell(self)

    def __rich__(self) -> Any:
        from vaso.report.terminal_runs import step_view

        return step_view(self)


@dataclass(frozen=True)
class OptimizationResult:
    """The best texts found, and how they were found. Truthy only if everything is verified.

    Attributes:
        optimizer: The optimizer's name.
        params: The best texts.
        initial: The texts at the start.
        values: Loss values of the best texts, by case.
        verified: True when every rule passes on every case.
        safety_before: Mean safety at the start.
        safety: Mean safety now.
        completion: Mean task completion now.
        steps: What each step did.
        spent: What it took.
        stop_reason: Why it stopped.
        error: What kept it from going on (a model that does not answer, an optimizer that fails
            again and again); empty where it came to an end of its own.
        out: The folder with checkpoint and log, if there is one.
        before: Loss values of the texts at the start, as far as this run has evaluated them: a
            resumed run does not do that again.
        violated_before: Rules that were violated at the start.
    """

    optimizer: str
    params: Parameters
    initial: Parameters
    values: Mapping[Case, LossValue]
    verified: bool
    safety_before: float
    safety: float
    completion: float
    steps: tuple[StepRecord, ...] = ()
    spent: Spent = field(default_factory=Spent)
    stop_reason: str = ""
    error: str = ""
    out: str | None = None
    before: Mapping[Case, LossValue] = field(default_factory=dict)
    violated_before: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        """True only if everything is verified."""
        return self.verified

    @property
    def skill(self) -> Skill:
        """The skill with the best texts."""
        return self.params.skill

    @property
    def initial_skill(self) -> Skill:
        """The skill at the start."""
        return self.initial.origin

    @property
    def results(self) -> dict[Case, VerificationResult | None]:
        """Verification results of the best texts, by case."""
        return {case: value.result for case, value in self.values.items()}

    @property
    def diff(self) -> str:
        """What changed from start to end."""
        return self.initial.diff(self.params)

    def summary(self) -> str:
        """The result in plain text."""
        lines = [self._headline(), f"stopped: {self.stop_reason}", f"spent: {self.spent}"]
        for step in self.steps:
            what = step.note or "changed" if step.accepted else step.error or _last_reason(step)
            mark = "accepted" if step.accepted else "rejected"
            lines.append(f"  step {step.step}: {mark}, safety {step.safety:.3f}: {what}")
        if self.diff:
            lines += ["", self.diff]
        return "\n".join(lines)

    def _headline(self) -> str:
        name, before, after = self.initial.origin.name, self.safety_before, self.safety
        if self.verified:
            tasks = f"{len(self.values)} task{'' if len(self.values) == 1 else 's'}"
            return f"{name}: verified on {tasks} (safety {before:.3f} -> 1.000)"
        kept = "the best version so far is kept" if self.diff else "nothing better was found"
        return f"{name}: NOT verified, {kept} (safety {before:.3f} -> {after:.3f})"

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "optimizer": self.optimizer,
            "skill": self.initial.origin.name,
            "verified": self.verified,
            "safety_before": self.safety_before,
            "violated_before": list(self.violated_before),
            "safety": self.safety,
            "completion": self.completion,
            "stop_reason": self.stop_reason,
            "error": self.error,
            "texts": dict(self.params),
            "diff": self.diff,
            "steps": [s.model_dump(mode="json") for s in self.steps],
            "spent": self.spent.to_json(),
            "cases": [_case_json(c, v) for c, v in self.values.items()],
            "out": self.out,
        }

    def __str__(self) -> str:
        return self.summary()

    def __rich__(self) -> Any:
        from vaso.report.terminal import optimization_view

        return optimization_view(self)

    def _repr_html_(self) -> str:
        from vaso.report.cells import optimization_cell

        return optimization_cell(self)


def _last_reason(step: StepRecord) -> str:
    if not step.tried:
        return "no proposal"
    more = f" (and {step.tried_count - 1} more)" if step.tried_count > 1 else ""
    return step.tried[-1].reason + more


def _case_json(case: Case, value: LossValue) -> dict[str, Any]:
    return {
        "task": case.task,
        "score": value.score,
        "completion": value.completion,
        "error": value.error,
        "plan": value.plan,
        "result": None if value.result is None else value.result.to_json(),
    }
