"""What a recording says about the rules of a skill."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from vaso.gradient import TextualGradient, textual_gradient
from vaso.gradient.model import Level
from vaso.ltl import to_english
from vaso.monitoring.monitor import Truth
from vaso.monitoring.recorded.recording import Recording
from vaso.monitoring.watch import RuleStatus
from vaso.platforms import Platform
from vaso.skill import Rule, Skill
from vaso.verdict import Counterexample, SpecResult, Verdict, VerificationResult

__all__ = ["TraceReport"]


@dataclass(frozen=True)
class TraceReport:
    """The rules of a skill on one recording. Truthy if none is violated, undecided or waiting.

    Attributes:
        recording: What was recorded.
        skill: The skill.
        platform: Its platform.
        statuses: For each rule, then for each assumption, what is known after the last state.
        counterexamples: For each violated rule, the recorded states up to the violation.
    """

    recording: Recording
    skill: Skill
    platform: Platform
    statuses: tuple[RuleStatus, ...]
    counterexamples: Mapping[Rule, Counterexample]

    @property
    def rules(self) -> tuple[RuleStatus, ...]:
        """What is known of the rules, without the assumptions."""
        return tuple(s for s in self.statuses if s.rule.role != "assumption")

    @property
    def violated(self) -> tuple[RuleStatus, ...]:
        """The rules that the recording violates."""
        return tuple(s for s in self.rules if s.truth is Truth.VIOLATED)

    @property
    def undecided(self) -> tuple[RuleStatus, ...]:
        """Rules that are open, and that something is missing for: an event, or a value."""
        return tuple(
            s for s in self.rules if s.truth is Truth.OPEN and (s.waits or s.unknown or s.problem)
        )

    @property
    def verdict(self) -> Verdict:
        """FAIL if a rule is violated, UNKNOWN if one is undecided, else PASS: of this recording."""
        if self.violated:
            return Verdict.FAIL
        return Verdict.UNKNOWN if self.undecided else Verdict.PASS

    def __bool__(self) -> bool:
        return bool(self.verdict)

    def result(self) -> VerificationResult:
        """The rules as a verification result, with the recorded counterexamples.

        A rule that is open stays UNKNOWN: a recording proves nothing about what was not recorded.
        """
        specs = tuple(self._spec(status) for status in self.rules)
        return VerificationResult(specs=specs, plan=self.recording.plan)

    def gradient(self, level: Level | str = Level.BLAME) -> TextualGradient | None:
        """Feedback for the author of the skill, as from a model checker; None without a violation.

        Args:
            level: How much to say.
        """
        if not self.violated:
            return None
        only = tuple(self._spec(status) for status in self.violated)
        result = VerificationResult(specs=only, plan=self.recording.plan)
        found = textual_gradient(result, skill=self.skill, level=level)
        kept = 1.0 - len(self.violated) / len(self.rules)
        where = f"recorded on the robot ({self.recording.source})"
        return found.model_copy(
            update={
                "score": kept,
                "verdict": "\n".join(f"{line}, {where}" for line in found.verdict.splitlines()),
                "trace": found.trace.replace(
                    "A behaviour of the plan that", "What was recorded, which"
                ),
            }
        )

    def _spec(self, status: RuleStatus) -> SpecResult:
        rule = status.rule
        verdicts = {Truth.VIOLATED: Verdict.FAIL, Truth.SATISFIED: Verdict.PASS}
        return SpecResult(
            spec=rule.text,
            formula=str(rule.formula),
            english=to_english(rule.formula, self.platform.phrases),
            role=rule.role,
            verdict=verdicts.get(status.truth, Verdict.UNKNOWN),
            engine="recording",
            counterexample=self.counterexamples.get(rule),
            reason=told(status, len(self.recording.samples)),
        )

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        gradient = self.gradient()
        recording = self.recording
        return {
            "verdict": self.verdict.value,
            "log": recording.source,
            "kind": recording.kind,
            "states": len(recording.samples),
            "dt": recording.dt,
            "skill": self.skill.name,
            "rules": [self._rule_json(status) for status in self.statuses],
            "gradient": str(gradient) if gradient else None,
        }

    def _rule_json(self, status: RuleStatus) -> dict[str, Any]:
        example = self.counterexamples.get(status.rule)
        return {
            "rule": status.rule.text,
            "role": status.rule.role,
            "english": to_english(status.rule.formula, self.platform.phrases),
            "kind": "safety" if status.is_safety else "liveness",
            "truth": status.truth.value,
            "step": status.step,
            "awaited": [str(f) for f in status.awaited],
            "unknown": list(status.unknown),
            "problem": status.problem,
            "counterexample": example.to_json() if example else None,
        }

    def __rich__(self) -> Any:
        from vaso.report.recorded import trace_view

        return trace_view(self)


def told(status: RuleStatus, states: int) -> str:
    """What is known of a rule, in a few words."""
    if status.problem:
        return f"not checked: {status.problem}"
    if status.truth is Truth.VIOLATED:
        return f"violated in step {status.step}"
    if status.truth is Truth.SATISFIED:
        return f"brought about in step {status.step}"
    if status.unknown:
        return f"not decided: the log does not always say {_listed(status.unknown)}"
    if status.waits:
        return f"not yet: {' and '.join(map(str, status.awaited))} has not come about"
    return f"kept in all {states} states"


def _listed(names: Sequence[str]) -> str:
    return " and ".join(names)
