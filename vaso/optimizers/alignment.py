"""A guard against labelling code that lies, and its feedback.

Labelling code is optimized like the other texts, and it decides what a rule means: a
``people_observed`` that always answers False makes every rule about people pass. So labels are
compared with the platform's true propositions, in every state of a plan and by proof and trials
besides (:mod:`vaso.labels`). A candidate must not be wrong where the first version was right; where
that was wrong already, the witness is feedback on the labelling code, and no rule that rests on a
wrong label counts as kept.
"""

from __future__ import annotations

from collections.abc import Iterable

from vaso.labels import QUICK, LabelReport, compare_states, label_feedback, validate_labels
from vaso.ltl import parse, propositions, variables
from vaso.optimizers.once import Once
from vaso.optimizers.parameters import digest
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Platform
from vaso.skill import Skill
from vaso.verdict import VerificationResult

_known: Once[tuple[Platform, LabelReport]] = Once()
"""Validations in this process, with the platform, so that its identity stays its own."""


class Alignment:
    """What is wrong with the labels of one plan.

    Args:
        skill: Its skill.
        result: The verdict on it.
        platform: The skill's platform.
    """

    def __init__(self, skill: Skill, result: VerificationResult, platform: Platform) -> None:
        self.in_plan = result.labels if result.labels is not None else LabelReport()
        self.anywhere = _validated(skill, platform)

    @property
    def wrong(self) -> frozenset[str]:
        """Propositions whose label is wrong somewhere."""
        return frozenset(c.name for r in (self.in_plan, self.anywhere) for c in r.wrong)

    def told(self, names: Iterable[str]) -> str:
        """Feedback on the labelling code about some propositions; empty where they are right."""
        chosen = set(names)
        seen = {c.name: c for r in (self.anywhere, self.in_plan) for c in r.wrong}
        merged = LabelReport(comparisons=tuple(c for n, c in sorted(seen.items()) if n in chosen))
        return label_feedback(merged)

    def feedback(self, others: dict[str, str]) -> dict[str, str]:
        """Feedback by text: the labelling code first where this plan's verdicts rest on it."""
        text = self.told(self.wrong)
        if not text:
            return others
        own = {"labelling_code": text}
        return own | others if self.in_plan.differing else others | own

    def safety(self, result: VerificationResult) -> float:
        """The fraction of rules that pass over labels that are true in the states of the plan.

        Putting a label right can only make this greater, though it may show a violation.
        """
        wrong = {c.name for c in self.in_plan.differing}
        if not wrong:
            return result.safety
        kept = [s for s in result.specs if s.verdict and not wrong & _names(s.formula)]
        return len(kept) / len(result.specs)


def misaligned(system: TransitionSystem, platform: Platform) -> frozenset[str]:
    """Names of the platform's propositions whose label differs from the truth in some state.

    Args:
        system: The transition system of a plan.
        platform: Supplies the dynamics and the sensors that decide the propositions.

    Returns:
        The names. Propositions that the platform does not know are not compared.
    """
    return frozenset(c.name for c in compare_states(system, platform).wrong)


def _validated(skill: Skill, platform: Platform) -> LabelReport:
    """The validation of a skill's labelling code; each is made once."""
    rules = [r.text for r in (*skill.rules, *skill.assumptions)]
    key = digest([str(id(platform)), skill.labelling_code, *rules])
    return _known.get(key, lambda: (platform, validate_labels(skill, platform, effort=QUICK)))[1]


def _names(formula: str) -> frozenset[str]:
    parsed = parse(formula)
    return frozenset((*propositions(parsed), *variables(parsed)))
