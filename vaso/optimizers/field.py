"""Violations that were recorded on a robot, as part of the loss of a skill.

The model checker knows the model; the field knows the world. A plan that passes in the model, and
has violated a rule on the robot, is not good enough: its loss says so, with the recorded behaviour
as textual gradient, until a candidate would have acted differently in the recorded situation.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vaso.gradient.model import TextualGradient
from vaso.optimizers.base import Case, LossValue
from vaso.optimizers.loss import SkillLoss
from vaso.optimizers.parameters import Parameters
from vaso.skill import Skill
from vaso.verdict import score_of

if TYPE_CHECKING:
    from vaso.monitoring.recorded import TraceReport

__all__ = ["FieldLoss", "field_reports"]


def field_reports(
    logs: Iterable[str | Path | TraceReport], skill: Skill
) -> tuple[TraceReport, ...]:
    """Recorded logs checked against the rules of a skill; reports are taken as they are.

    Raises:
        VasoError: A log cannot be read, or is from another platform.
    """
    from vaso.monitoring.recorded import TraceReport, check_log

    return tuple(log if isinstance(log, TraceReport) else check_log(log, skill) for log in logs)


class FieldLoss:
    """A loss that recorded violations are part of.

    A violation counts against texts whose plan would have sent the same commands in the recorded
    situation; a log that does not say which plan ran counts against the texts at the start too.

    Args:
        loss: The loss in the model.
        reports: What was recorded.
    """

    def __init__(self, loss: SkillLoss, reports: Sequence[TraceReport]) -> None:
        self.loss = loss
        self.reports = tuple(report for report in reports if report.violated)
        self._known: dict[tuple[str, str], tuple[TraceReport, ...]] = {}

    def __call__(self, params: Parameters, case: Case) -> LossValue:
        """Evaluate texts on a case, in the model and against the recordings."""
        value = self.loss(params, case)
        against = () if value.error else self._against(params, value.plan)
        if not against:
            return value
        rules = max(1, len(params.skill.rules))
        violated = {s.rule.text for report in against for s in report.violated}
        told = "\n".join(f"violated {rule} on the robot" for rule in sorted(violated))
        feedback = dict(value.feedback)
        feedback["plan_template"] = "\n".join(
            filter(None, (feedback.get("plan_template", ""), told))
        )
        return replace(
            value,
            score=score_of(False, min(value.score, 1.0 - len(violated) / rules)),
            feedback=feedback,
            make_gradient=lambda: self._gradient(value, against),
        )

    def with_system(self, params: Parameters, value: LossValue) -> LossValue:
        """A value whose result has its transition system."""
        return self.loss.with_system(params, value)

    def state(self) -> dict[str, Any]:
        """What a checkpoint keeps."""
        return self.loss.state()

    def restore(self, state: Mapping[str, Any]) -> None:
        """Take up the state of an earlier run."""
        self.loss.restore(state)

    def _against(self, params: Parameters, plan: str) -> tuple[TraceReport, ...]:
        key = params.key, plan
        if key not in self._known:
            self._known[key] = tuple(r for r in self.reports if self._stands(r, params, plan))
        return self._known[key]

    def _stands(self, report: TraceReport, params: Parameters, plan: str) -> bool:
        """Whether a recording still speaks against the texts."""
        from vaso.monitoring.recorded.replay import would_repeat

        recording = report.recording
        if not recording.plan and params.key == self.loss.initial.key:
            return True
        if recording.plan.strip() == plan.strip():
            return True
        return any(
            would_repeat(recording, status.step or 0, params.skill, plan, report.platform)
            for status in report.violated
        )

    def _gradient(self, value: LossValue, against: Sequence[TraceReport]) -> TextualGradient:
        """The model's gradient, and after it what was recorded."""
        found = [g for r in against if (g := r.gradient(self.loss.level)) is not None]
        model = value.gradient
        told = [*([] if model.passed else [model]), *found]

        def joined(part: str) -> str:
            return "\n\n".join(dict.fromkeys(t for g in told if (t := getattr(g, part))))

        return model.model_copy(
            update={
                "score": min([model.score, *(g.score for g in found)]),
                "passed": False,
                "verdict": "\n".join(dict.fromkeys(g.verdict for g in told)),
                "trace": joined("trace"),
                "blame": joined("blame"),
            }
        )
