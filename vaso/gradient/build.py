"""Build a TextualGradient from a verification result (paper, section 4.2)."""

from __future__ import annotations

from collections.abc import Sequence

from vaso.concurrency.result import CompositionResult
from vaso.errors import VasoError
from vaso.gradient.blame import Blame, blame
from vaso.gradient.model import PASS_TEXT, Edit, Level, TextualGradient
from vaso.gradient.notes import notes
from vaso.gradient.trace import trace_table
from vaso.labels.feedback import label_feedback
from vaso.platforms import Platform, get_platform
from vaso.skill import Skill
from vaso.verdict import SpecResult, Verdict, VerificationResult

__all__ = ["blames", "observations", "textual_gradient"]


def textual_gradient(
    result: VerificationResult,
    *,
    skill: Skill | None = None,
    level: Level | str = Level.BLAME,
    repair: Edit | None = None,
) -> TextualGradient:
    """Turn a verification result into feedback for the author of a skill.

    Args:
        result: The result; of a composition, the feedback names the plan to change.
        skill: The skill; its platform says which propositions sensors decide.
        level: How much to say: ``verdict``, ``trace``, ``blame`` or ``repair``; each includes the
            ones before it.
        repair: A verified edit, for level ``repair`` (see :func:`vaso.gradient.find_repair`).

    Raises:
        ValueError: There is no such level.
    """
    level = Level(level)
    if isinstance(result, CompositionResult):
        from vaso.concurrency.gradient import joint_gradient

        return joint_gradient(result, level=level)
    if result and not _differing(result):
        return TextualGradient(
            level=level,
            score=result.safety,
            passed=True,
            verdict=PASS_TEXT,
            notes=notes(result),
        )
    rank = list(Level).index(level)
    observed = observations(result, skill)
    return TextualGradient(
        level=level,
        score=result.safety,
        passed=False,
        verdict=_verdict(result),
        trace=_traces(result, observed) if rank >= 1 else "",
        blame=_blame_text(result, skill) if rank >= 2 else "",
        repair=repair if rank >= 3 else None,
        notes=notes(result),
    )


def blames(
    result: VerificationResult, skill: Skill | None = None
) -> list[tuple[SpecResult, Blame]]:
    """What is to blame for each violated formula that has a counterexample."""
    observed, sensors = observations(result, skill), _sensors(skill)
    return [
        (spec, blame(spec.counterexample, result.plan, observed=observed, sensors=sensors))
        for spec in result.failures
        if spec.counterexample is not None
    ]


def observations(result: VerificationResult, skill: Skill | None = None) -> frozenset[str]:
    """The propositions that sensors decide, as far as the result and the skill's platform show."""
    system = result.system
    labelled = {name for state in system.states for name in state.observed} if system else set()
    platform = _platform(skill)
    known = (
        {p.name for p in platform.propositions if p.kind == "observation"} if platform else set()
    )
    return frozenset(labelled | known)


def _platform(skill: Skill | None) -> Platform | None:
    if skill is None:
        return None
    try:
        return get_platform(skill.platform)
    except VasoError:
        return None


def _sensors(skill: Skill | None) -> dict[str, str]:
    platform = _platform(skill)
    return {p.name: p.sensor for p in platform.propositions if p.sensor} if platform else {}


def _differing(result: VerificationResult) -> list[str]:
    """Propositions of the rules whose labels are wrong about the robot."""
    return [c.name for c in result.labels.differing] if result.labels is not None else []


def _verdict(result: VerificationResult) -> str:
    wrong = [label_feedback(result.labels, names) for names in [_differing(result)] if names]
    if result:
        return "\n".join(["every rule passes, but not for this robot:", *wrong])
    lines = [f"violates {s.formula}" for s in result.failures if s.verdict is Verdict.FAIL]
    lines = [*wrong, *lines]
    if result.problem is not None:
        return "\n".join([*lines, f"cannot be verified: {result.problem.message}"])
    open_: dict[str, list[str]] = {}
    for spec in result.failures:
        if spec.verdict is not Verdict.FAIL:
            open_.setdefault(spec.reason, []).append(spec.formula)
    lines += [f"cannot decide {', '.join(f)}{_because(reason)}" for reason, f in open_.items()]
    return "\n".join(lines) or "there is no formula to verify"


def _because(reason: str) -> str:
    return f" ({reason})" if reason else ""


def _traces(result: VerificationResult, observed: frozenset[str]) -> str:
    """One table for each counterexample."""
    parts = []
    for spec in result.failures:
        if spec.counterexample is not None:
            table = trace_table(spec.counterexample, observed)
            parts.append(f"A behaviour of the plan that violates {spec.formula}:\n{table}")
    return "\n\n".join(parts)


def _blame_text(result: VerificationResult, skill: Skill | None) -> str:
    found = [f"{spec.formula}: {b.text}" for spec, b in blames(result, skill)]
    if result.problem is not None and result.problem.line is not None:
        found.append(_quoted(result.plan, result.problem.line))
    return "\n".join(f for f in found if f)


def _quoted(plan: str, line: int) -> str:
    lines: Sequence[str] = plan.splitlines()
    return f"line {line}: `{lines[line - 1].strip()}`" if 0 < line <= len(lines) else ""
