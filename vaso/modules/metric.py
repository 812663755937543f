"""The verifier as a DSPy metric: ``dspy.Evaluate``, ``dspy.GEPA``, ``dspy.SIMBA`` and others."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import dspy

from vaso.errors import SkillError
from vaso.gradient.model import Level
from vaso.modules.asking import code_of
from vaso.modules.attempts import level_of
from vaso.modules.composition import Composition
from vaso.modules.verdicts import verdicts
from vaso.plan.model import Plan
from vaso.skill import Skill
from vaso.skill_file import load_skill
from vaso.verdict import score_of
from vaso.verifiers import Verifier

NO_PLAN = "There is no plan: the output field '{field}' is missing or empty."


def verifier_metric(
    skill: Skill | str | Path | None = None,
    *,
    level: Level | str = Level.BLAME,
    field: str = "plan",
    feedback: bool = True,
    verifier: str | Verifier | None = None,
) -> VerifierMetric:
    """A metric that verifies plans: ``metric(gold, pred, trace, pred_name, pred_trace)``.

    Args:
        skill: The skill whose rules count. By default the one that the prediction names in its
            field ``skill``, as those of a :class:`~vaso.modules.SkillProgram` do. Of the
            prediction of a :class:`~vaso.modules.SkillRouter`, the parts count as well.
        level: How much the feedback says: ``verdict``, ``trace``, ``blame`` or ``repair``.
        field: The output field that holds the plan: a text (fences are removed) or a plan.
        feedback: False gives a plain number.
        verifier: A verifier or its name.

    Returns:
        The metric, for example for ``dspy.Evaluate(devset=tasks, metric=verifier_metric("drive"))``
        or ``dspy.GEPA(metric=verifier_metric("drive"), reflection_lm=lm, auto="light")``.

    Raises:
        SkillError: There is no such skill, or no such level.
    """
    known = skill is None or isinstance(skill, Skill)
    found = skill if known else load_skill(skill)  # type: ignore[arg-type]
    return VerifierMetric(found, level_of(level), field, feedback, verifier)  # type: ignore[arg-type]


@dataclass(frozen=True)
class VerifierMetric:
    """What :func:`verifier_metric` makes.

    The score is the plan's safety, the fraction of rules that pass; 1.0 means verified. With it
    comes feedback: what is violated, in which behaviour, and which line is to blame. No plan is
    verified twice, by this metric or by a :class:`~vaso.modules.SkillProgram`.

    Attributes:
        skill: The skill whose rules count, or None for the prediction's own.
        level: How much the feedback says.
        field: The output field that holds the plan.
        feedback: Whether there is feedback with the score.
        verifier: A verifier or its name.
    """

    skill: Skill | None
    level: Level = Level.BLAME
    field: str = "plan"
    feedback: bool = True
    verifier: str | Verifier | None = None

    def __call__(
        self,
        gold: Any,
        pred: Any,
        trace: Any = None,
        pred_name: str | None = None,
        pred_trace: Any = None,
    ) -> Any:
        """Score a prediction.

        Args:
            gold: The example. Nothing in it is looked at: the rules say what a good plan is.
            pred: The prediction.
            trace: Given where a demonstration is bootstrapped.
            pred_name: The predictor that feedback is for, where GEPA asks; it is the same for all.
            pred_trace: That predictor's calls.

        Returns:
            ``dspy.Prediction(score=…, feedback=…)``, or the score alone. Where a demonstration is
            bootstrapped: whether the plan is verified.

        Raises:
            SkillError: Neither the metric nor the prediction names a skill.
        """
        score, feedback = self._judged(pred)
        if trace is not None and pred_name is None:
            return score >= 1.0
        return dspy.Prediction(score=score, feedback=feedback) if self.feedback else score

    def _judged(self, pred: Any) -> tuple[float, str]:
        composition = getattr(pred, "composition", None)
        if self.skill is None and isinstance(composition, Composition):
            return score_of(bool(composition), composition.safety), composition.feedback
        plan = self._plan(pred)
        if plan is None:
            return 0.0, NO_PLAN.format(field=self.field)
        skill = self.skill or _skill_of(pred)
        result = verdicts.result(skill, plan, self.verifier)
        feedback = verdicts.feedback(skill, plan, self.level, self.verifier)
        return score_of(bool(result), result.safety), feedback

    def _plan(self, pred: Any) -> Plan | None:
        found = getattr(pred, self.field, None)
        if isinstance(found, Plan):
            return found if found.source.strip() else None
        source = code_of(found) if isinstance(found, str) else ""
        return Plan(source=source) if source else None


def _skill_of(pred: Any) -> Skill:
    skill = getattr(pred, "skill", None)
    if isinstance(skill, Skill):
        return skill
    raise SkillError(
        "the prediction does not say which skill its plan is of",
        expected="verifier_metric(skill), or the prediction of a vaso.modules.SkillProgram",
    )
