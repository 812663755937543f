"""Mutation analysis: how many wrong plans do the rules of a skill find?

Each verified template is changed in many small ways (DeMillo, Lipton and Sayward, *Hints on test
data selection*, 1978). A mutant is *killed* when some rule fails. A survivor is either *equivalent*
(its automaton does the same as the template's) or shows what the rules leave open.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from vaso.evidence.equivalence import same_behaviour
from vaso.evidence.mutants import Mutant, mutants
from vaso.optimizers.completion import completion, purpose
from vaso.plan.explore import Budget
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Platform, get_platform
from vaso.skill import Skill
from vaso.verdict import Verdict, VerificationResult
from vaso.verification.verifying import verify

BUDGET = Budget(states=3_000, seconds=30.0)


class Fate(StrEnum):
    """What became of a mutant."""

    KILLED = "killed"
    INVALID = "no plan"
    UNKNOWN = "unknown"
    EQUIVALENT = "equivalent"
    SURVIVED = "survived"


@dataclass(frozen=True, slots=True)
class Outcome:
    """A mutant and what became of it.

    Attributes:
        mutant: The mutant.
        fate: What became of it.
        verdict: The verdict on it.
        rules: The rules that failed.
        reason: For what was not decided: why.
        lost: For a survivor: what part of the task it gives up, as far as can be told without a
            simulation (see :mod:`vaso.optimizers.completion`).
    """

    mutant: Mutant
    fate: Fate
    verdict: Verdict
    rules: tuple[str, ...] = ()
    reason: str = ""
    lost: tuple[str, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "operator": self.mutant.operator,
            "line": self.mutant.line,
            "before": self.mutant.before,
            "after": self.mutant.after,
            "fate": self.fate.value,
            "verdict": self.verdict.value,
            "rules": list(self.rules),
            "reason": self.reason,
            "lost": list(self.lost),
        }


@dataclass(frozen=True, slots=True)
class Analysis:
    """The mutants of one skill's template.

    Attributes:
        skill: The skill's name.
        outcomes: One per mutant.
    """

    skill: str
    outcomes: tuple[Outcome, ...]

    def count(self, fate: Fate) -> int:
        """How many had this fate."""
        return sum(o.fate is fate for o in self.outcomes)

    @property
    def score(self) -> float:
        """Killed mutants, as a fraction of the plans that behave differently and were decided."""
        killed, survived = self.count(Fate.KILLED), self.count(Fate.SURVIVED)
        return killed / (killed + survived) if killed + survived else 1.0

    @property
    def survivors(self) -> tuple[Outcome, ...]:
        """The mutants that behave differently and keep every rule."""
        return tuple(o for o in self.outcomes if o.fate is Fate.SURVIVED)

    def kills(self) -> Counter[str]:
        """How many mutants each rule killed."""
        return Counter(rule for o in self.outcomes for rule in o.rules)

    def to_json(self) -> dict[str, Any]:
        """Plain data for ``--json``."""
        return {
            "skill": self.skill,
            "mutants": len(self.outcomes),
            "score": self.score,
            "fates": {fate.value: self.count(fate) for fate in Fate},
            "kills": dict(self.kills()),
            "outcomes": [o.to_json() for o in self.outcomes],
        }


def analyse(
    skill: Skill,
    count: int,
    seed: int = 0,
    on_mutant: Callable[[int], None] | None = None,
) -> Analysis:
    """Mutate a skill's template and verify every mutant.

    Args:
        skill: The skill; its template must be verified.
        count: Number of mutants.
        seed: Which mutants.
        on_mutant: Called with the number of mutants so far.

    Raises:
        ValueError: The template itself is not verified.
    """
    original = verify(skill, skill.plan_template, counterexamples=False)
    if not original:
        raise ValueError(f"the template of '{skill.name}' is not verified: {original.verdict}")
    outcomes, robot = [], get_platform(skill.platform)
    for number, mutant in enumerate(mutants(skill.plan_template, count, seed)):
        if on_mutant:
            on_mutant(number)
        found = verify(skill, mutant.text, budget=BUDGET, counterexamples=False)
        outcomes.append(_outcome(mutant, found, original.system, robot))
    return Analysis(skill.name, tuple(outcomes))


def _outcome(
    mutant: Mutant, found: VerificationResult, original: TransitionSystem, robot: Platform
) -> Outcome:
    failed = tuple(s.spec for s in found.specs if s.verdict is Verdict.FAIL)
    reason = found.problem.message.split("\n")[0] if found.problem else ""
    fate = _fate(found, original)
    lost: tuple[str, ...] = ()
    if fate is Fate.SURVIVED:
        _, lost = completion(purpose(original, robot), purpose(found.system, robot))
    return Outcome(mutant, fate, found.verdict, failed, reason, lost)


def _fate(found: VerificationResult, original: TransitionSystem) -> Fate:
    if found.verdict is Verdict.FAIL:
        return Fate.KILLED
    if found.verdict is Verdict.UNSUPPORTED:
        return Fate.INVALID
    if found.verdict is Verdict.UNKNOWN:
        return Fate.UNKNOWN
    return Fate.EQUIVALENT if same_behaviour(original, found.system) else Fate.SURVIVED
