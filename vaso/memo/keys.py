"""The key of a verdict: a hash of everything that it is a function of."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from vaso.ltl import Formula
from vaso.memo.sources import code_digest, engine_version, platform_digest
from vaso.plan.explore import Budget
from vaso.plan.model import Plan
from vaso.platforms import Platform
from vaso.skill import Rule, Skill
from vaso.verifiers import Verifier

__all__ = ["SKILL_PARTS", "key_of"]

SKILL_PARTS = ("rules", "assumptions", "labelling_code", "platform")
"""What a verdict depends on in a skill. Names and places only appear in messages."""

_DEFAULT = "auto"


def key_of(
    skill: Skill,
    plan: Plan,
    *,
    platform: str | Path | Platform | None = None,
    specs: Sequence[str | Formula | Rule] = (),
    verifier: str | Verifier | None = None,
    budget: Budget | None = None,
    options: Mapping[str, Any] | None = None,
) -> str | None:
    """The key of a verdict, or None where it depends on something that has no text.

    Bounds on time are not in it, since a verdict that they have touched is never kept.

    Args:
        skill: The skill.
        plan: The plan.
        platform: As for :func:`vaso.verify`; likewise the next three.
        specs: Formulas besides the skill's rules.
        verifier: The verifier. An object has no text.
        budget: Bounds of the exploration.
        options: Further options of ``verify``.
    """
    code, robot = code_digest(), platform_digest(platform or skill.platform)
    engine = _DEFAULT if verifier is None else verifier
    if code is None or robot is None or not isinstance(engine, str):
        return None
    bounds = budget or Budget()
    parts = {
        "code": code,
        "engine": [engine.lower(), engine_version(engine.lower())],
        "platform": robot,
        "rules": [_rule(rule) for rule in (*skill.rules, *skill.assumptions)],
        "specs": [_spec(spec) for spec in specs],
        "labelling": skill.labelling_code,
        "plan": plan.source,
        "bounds": [bounds.states, bounds.branches],
        "options": dict(options or {}),
    }
    try:
        text = json.dumps(parts, sort_keys=True)
    except (TypeError, ValueError):
        return None
    return hashlib.blake2b(text.encode(), digest_size=20).hexdigest()


def _rule(rule: Rule) -> list[str]:
    return [rule.role, rule.text]


def _spec(spec: str | Formula | Rule) -> list[str]:
    if isinstance(spec, Rule):
        return _rule(spec)
    return ["text" if isinstance(spec, str) else "formula", str(spec)]
