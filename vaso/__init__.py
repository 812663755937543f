"""VASO: robot skills written by language models, checked before they move.

Six nouns (Skill, Platform, Plan, TransitionSystem, Verdict, TextualGradient), two verbs
(verify, optimize). Everything here is imported on first use, so that ``import vaso`` is quick and
needs no language-model framework, robot library or model checker.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_EXPORTS = {
    "Skill": "vaso.skill",
    "Rule": "vaso.skill",
    "shipped_skills": "vaso.skill",
    "load_skill": "vaso.skill_file",
    "read_skills": "vaso.skill_file",
    "write_skill": "vaso.skill_file",
    "load_tasks": "vaso.skill_file",
    "Platform": "vaso.platforms",
    "get_platform": "vaso.platforms",
    "Plan": "vaso.plan",
    "TransitionSystem": "vaso.plan",
    "compile_plan": "vaso.plan",
    "Verdict": "vaso.verdict",
    "Counterexample": "vaso.verdict",
    "VerificationResult": "vaso.verdict",
    "verify": "vaso.verification",
    "verify_many": "vaso.parallel",
    "compose": "vaso.concurrency",
    "preempt": "vaso.concurrency",
    "Member": "vaso.concurrency",
    "LabelReport": "vaso.labels",
    "validate_labels": "vaso.labels",
    "check": "vaso.feasibility",
    "satisfiable": "vaso.feasibility",
    "realizability": "vaso.synthesis",
    "TextualGradient": "vaso.gradient",
    "textual_gradient": "vaso.gradient",
    "optimize": "vaso.optimizers",
    "OptimizationResult": "vaso.optimizers",
    "VasoError": "vaso.errors",
}

__all__ = [
    "Counterexample",
    "LabelReport",
    "Member",
    "OptimizationResult",
    "Plan",
    "Platform",
    "Rule",
    "Skill",
    "TextualGradient",
    "TransitionSystem",
    "VasoError",
    "Verdict",
    "VerificationResult",
    "__version__",
    "check",
    "compile_plan",
    "compose",
    "get_platform",
    "load_skill",
    "load_tasks",
    "optimize",
    "preempt",
    "read_skills",
    "realizability",
    "satisfiable",
    "shipped_skills",
    "textual_gradient",
    "validate_labels",
    "verify",
    "verify_many",
    "write_skill",
]

if TYPE_CHECKING:
    from vaso.concurrency import Member, compose, preempt
    from vaso.errors import VasoError
    from vaso.feasibility import check, satisfiable
    from vaso.gradient import TextualGradient, textual_gradient
    from vaso.labels import LabelReport, validate_labels
    from vaso.optimizers import OptimizationResult, optimize
    from vaso.parallel import verify_many
    from vaso.plan import Plan, TransitionSystem, compile_plan
    from vaso.platforms import Platform, get_platform
    from vaso.skill import Rule, Skill, shipped_skills
    from vaso.skill_file import load_skill, load_tasks, read_skills, write_skill
    from vaso.synthesis import realizability
    from vaso.verdict import Counterexample, Verdict, VerificationResult
    from vaso.verification import verify


def __getattr__(name: str) -> Any:
    if name in _EXPORTS:
        return getattr(import_module(_EXPORTS[name]), name)
    raise AttributeError(f"module 'vaso' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
