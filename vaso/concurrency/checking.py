"""Checking rules on a product: what the robots are together, and whose run a violation is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from vaso.concurrency.explaining import explain_jointly
from vaso.concurrency.members import Explored
from vaso.concurrency.product import Product
from vaso.concurrency.schedule import Schedule
from vaso.ltl import Formula
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Issued, Platform
from vaso.skill import Rule, Skill
from vaso.verdict import Counterexample, Verdict
from vaso.verification.task import Finding, Task
from vaso.verifiers import Verifier

__all__ = ["JointTask", "joint_platform"]

_NOT_REPLAYED = "a violation was found, but it could not be replayed on the plans"


def joint_platform(members: Sequence[Explored], schedule: Schedule) -> Platform:
    """The robots as one platform: qualified propositions, and which exclude each other."""
    robots = [(m.name, m.platform) for m in members if m.platform is not None]
    return Platform(
        name="composition",
        description="several robots",
        dt=schedule.dt or 1.0,
        commands=(),
        rest=Issued(name="rest"),
        propositions=tuple(
            p.model_copy(update={"name": f"{name}.{p.name}", "phrase": "", "sensor": None})
            for name, robot in robots
            for p in robot.propositions
        ),
        exclusions=tuple(
            tuple(f"{name}.{action}" for action in group)
            for name, robot in robots
            for group in robot.exclusions
        ),
        dynamics=None,
    )


class JointTask(Task):
    """Checks formulas on a product, and explains violations on the members.

    Args:
        system: The product of the reduced members.
        product: The product of the members as they were explored.
        robot: The members' platforms as one.
        assumptions: What the environment and the schedule are trusted to do.
        verifier: Decides formulas.
        timeout: Seconds for everything.
        counterexamples: Whether to compute violating runs.
    """

    def __init__(
        self,
        system: TransitionSystem,
        product: Product,
        robot: Platform,
        assumptions: Sequence[Rule],
        verifier: Verifier,
        timeout: float,
        counterexamples: bool,
    ) -> None:
        skill = Skill(name="composition", platform=robot.name)
        super().__init__(system, skill, robot, verifier, timeout, counterexamples)
        # Those of the members were looked at where they are from; fairness is about the turn.
        self.assumptions = tuple(assumptions)
        self.product = product
        self._explained: dict[int, Counterexample] = {}

    def findings(self, formulas: Sequence[Formula]) -> list[Finding]:
        """See :class:`Task`. A violation that cannot be replayed on the members is UNKNOWN."""
        findings = super().findings(formulas)
        for finding in findings:
            lasso = finding.answer.lasso
            if finding.answer.verdict is not Verdict.FAIL or lasso is None:
                continue
            found = explain_jointly(self.product, lasso, finding.formula)
            if found is None:
                finding.answer = replace(
                    finding.answer, verdict=Verdict.UNKNOWN, lasso=None, reason=_NOT_REPLAYED
                )
            else:
                self._explained[id(finding)] = found
        return findings

    def counterexample(self, finding: Finding) -> Counterexample | None:
        """The violating run of a finding, with what every member does."""
        return self._explained.get(id(finding))
