"""The result of a plan that no worker could decide."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from vaso.errors import VasoError
from vaso.ltl import Formula, ParsedFormula, parse_with_warnings, to_english
from vaso.platforms import Platform, get_platform
from vaso.skill import Rule, Skill
from vaso.verdict import Problem, SpecResult, Verdict, VerificationResult

__all__ = ["undecided"]


def undecided(
    skill: Skill,
    source: str,
    reason: str,
    *,
    kind: str = "unknown",
    specs: Sequence[str | Formula | Rule] = (),
    platform: str | Path | Platform | None = None,
) -> VerificationResult:
    """A result in which every rule has the same reason for having no verdict.

    Args:
        skill: The skill.
        source: The plan's text.
        reason: Why.
        kind: ``unknown``, or ``input`` where what was asked for is wrong.
        specs: Formulas besides the skill's rules.
        platform: Overrides the skill's platform.
    """
    phrases = _phrases(platform or skill.platform)
    verdict = Verdict.UNKNOWN if kind == "unknown" else Verdict.UNSUPPORTED
    asked = [*((r.parsed, r.role) for r in skill.rules), *map(_spec, specs)]
    results = (
        SpecResult(
            spec=parsed.text,
            formula=str(parsed.formula),
            english=to_english(parsed.formula, phrases),
            role=role,
            verdict=verdict,
            reason=reason,
            warnings=parsed.warnings,
        )
        for parsed, role in asked
    )
    return VerificationResult(tuple(results), plan=source, problem=Problem(kind, reason))


def _spec(spec: str | Formula | Rule) -> tuple[ParsedFormula, str]:
    if isinstance(spec, Rule):
        return spec.parsed, spec.role
    if isinstance(spec, str):
        return parse_with_warnings(spec), "extra"
    return ParsedFormula(spec, str(spec)), "extra"


def _phrases(platform: str | Path | Platform) -> dict[str, str]:
    try:
        return get_platform(platform).phrases
    except VasoError:
        return {}
