"""Environment assumptions of a skill: LTL over sensors only, and possible."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

from vaso.errors import FormulaError, SkillError
from vaso.ltl import Proposition, comparisons, conjunction, negate, propositions
from vaso.plan.atoms import truth_table
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Platform
from vaso.skill import Rule
from vaso.verdict import Verdict
from vaso.verifiers.base import Answer, Verifier

__all__ = ["require_possible", "require_sensors_only"]

_EXPECTED = "an assumption speaks about observations only, such as G F !people_observed"


def require_sensors_only(
    assumptions: Sequence[Rule], system: TransitionSystem, robot: Platform, source: str
) -> None:
    """Refuse assumptions about anything but what the sensors say.

    An assumption about commands or numbers would assume what the plan is there to ensure.

    Raises:
        SkillError: An assumption mentions an action, a number, or something that does not exist.
    """
    for rule in assumptions:
        for comparison in comparisons(rule.formula):
            raise _refused(rule, f"compares numbers ({comparison})", source)
        for name in sorted(propositions(rule.formula)):
            spec = robot.proposition(name)
            if spec is not None and spec.kind != "observation":
                raise _refused(rule, f"mentions '{name}', which is not an observation", source)
            if not _is_observation(system, name):
                raise _refused(rule, f"mentions '{name}', which is not decided by sensors", source)


def _is_observation(system: TransitionSystem, name: str) -> bool:
    """True when the sensors alone decide the proposition, in the same way in every state."""
    try:
        table = truth_table(system, Proposition(name))
    except FormulaError:
        return False
    return len({_key(truth) for truth in table}) == 1


def _key(truth: object) -> Hashable:
    if isinstance(truth, tuple):
        return frozenset(frozenset(guard.items()) for guard in truth)
    return bool(truth)


def require_possible(
    assumptions: Sequence[Rule],
    system: TransitionSystem,
    verifier: Verifier,
    timeout: float,
    source: str,
) -> Answer:
    """Refuse assumptions that no behaviour of the sensors satisfies: they would prove anything.

    Returns:
        The verifier's answer; other than FAIL, it does not know.

    Raises:
        SkillError: The assumptions contradict each other.
    """
    joint = conjunction(rule.formula for rule in assumptions)
    answer = verifier.check(system, [negate(joint)], timeout=timeout, counterexamples=False)[0]
    if answer.verdict is Verdict.PASS:
        texts = " and ".join(rule.text for rule in assumptions)
        raise SkillError(
            f"no behaviour of the environment satisfies {texts}",
            source=source,
            expected="assumptions that can be true together",
        )
    return answer


def _refused(rule: Rule, why: str, source: str) -> SkillError:
    return SkillError(f"the assumption {rule.text} {why}", source=source, expected=_EXPECTED)
