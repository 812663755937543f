"""One verification: every rule on one transition system, in a few calls of the verifier."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from vaso.ltl import Formula
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Platform
from vaso.skill import Rule, Skill
from vaso.verdict import Counterexample, Verdict
from vaso.verification.assumptions import require_possible, require_sensors_only
from vaso.verification.counterexample import explain_run
from vaso.verification.queries import Checker, Query
from vaso.verification.regardless import Passed
from vaso.verification.vacuity import Vacuity, look_for_vacuity
from vaso.verifiers import Answer, Verifier
from vaso.verifiers.runs import violates

__all__ = ["Finding", "Task"]

_NOT_SHOWN = "it needs the skill's assumptions, and it is not known whether they can be true"


@dataclass
class Finding:
    """What is known about one formula.

    Attributes:
        formula: The formula.
        answer: The answer that counts.
        seconds: Wall time of all answers about it.
        needed: Assumptions that a PASS rests on.
        vacuity: For a PASS: whether it says anything about the plan.
    """

    formula: Formula
    answer: Answer
    seconds: float = 0.0
    needed: tuple[Rule, ...] = ()
    vacuity: Vacuity = field(default_factory=Vacuity)

    def take(self, answer: Answer) -> None:
        """Let a later answer count instead."""
        self.answer = answer
        self.seconds += answer.seconds

    def query(self, given: Sequence[Rule]) -> Query:
        """The question whether the formula holds under some assumptions."""
        return Query(self.formula, tuple(rule.formula for rule in given))


class Task:
    """Checks formulas on one system under the assumptions of a skill.

    Args:
        system: The system of the plan.
        skill: Supplies the assumptions.
        robot: The platform.
        verifier: Decides formulas.
        timeout: Seconds for everything.
        counterexamples: Whether to compute violating runs.

    Raises:
        SkillError: The skill's assumptions are not about sensors.
    """

    def __init__(
        self,
        system: TransitionSystem,
        skill: Skill,
        robot: Platform,
        verifier: Verifier,
        timeout: float,
        counterexamples: bool,
    ) -> None:
        self.system = system
        self.robot = robot
        self.assumptions = skill.assumptions
        self.source = skill.source or skill.name
        self.checker = Checker(system, verifier, timeout)
        self.counterexamples = counterexamples
        require_sensors_only(self.assumptions, system, robot, self.source)

    def findings(self, formulas: Sequence[Formula]) -> list[Finding]:
        """Check formulas: alone, then under assumptions, then for vacuity."""
        answers = self._ask([Query(f) for f in formulas])
        findings = [Finding(f, a, a.seconds) for f, a in zip(formulas, answers, strict=True)]
        if self.assumptions:
            self._assume([f for f in findings if f.answer.verdict is not Verdict.PASS])
        self._look_for_vacuity([f for f in findings if f.answer.verdict is Verdict.PASS])
        return findings

    def counterexample(self, finding: Finding) -> Counterexample | None:
        """The violating run of a finding, step by step."""
        lasso = finding.answer.lasso
        return None if lasso is None else explain_run(self.system, lasso, finding.formula)

    def _ask(self, queries: Sequence[Query]) -> list[Answer]:
        return self.checker.ask(queries, counterexamples=self.counterexamples)

    # --- assumptions ---------------------------------------------------------------------------

    def _assume(self, failed: list[Finding]) -> None:
        """Check again what does not hold on its own, and find out which assumptions it needs."""
        open_ = [f for f in failed if not self._fails_under_assumptions(f)]
        # A violating run that keeps the assumptions shows that they can be kept.
        possible = len(open_) < len(failed) or self._are_possible()
        failed = open_
        for finding, answer in self._under(failed, [self.assumptions] * len(failed)):
            if answer.verdict is Verdict.PASS and not possible:
                answer = replace(answer, verdict=Verdict.UNKNOWN, reason=_NOT_SHOWN)
            if answer.verdict is Verdict.PASS:
                finding.needed = self.assumptions
            if finding.answer.verdict is Verdict.FAIL or answer.verdict is Verdict.PASS:
                finding.take(answer)
        for rule in self.assumptions:
            self._try_without(rule, [f for f in failed if len(f.needed) > 1])

    def _fails_under_assumptions(self, finding: Finding) -> bool:
        """True when the run that is known violates the rule and keeps the assumptions as well."""
        lasso = finding.answer.lasso
        if lasso is None or self.checker.is_cut:
            return False
        asked = finding.query(self.assumptions).under_assumptions(finding.formula)
        return violates(self.system, lasso, asked)

    def _try_without(self, rule: Rule, findings: list[Finding]) -> None:
        fewer = [tuple(r for r in f.needed if r is not rule) for f in findings]
        for (finding, answer), rest in zip(self._under(findings, fewer), fewer, strict=True):
            finding.seconds += answer.seconds
            if answer.verdict is Verdict.PASS:
                finding.needed = rest

    def _under(
        self, findings: Sequence[Finding], given: Sequence[Sequence[Rule]]
    ) -> list[tuple[Finding, Answer]]:
        queries = [f.query(rules) for f, rules in zip(findings, given, strict=True)]
        return list(zip(findings, self._ask(queries), strict=True))

    def _are_possible(self) -> bool:
        left = max(0.0, self.checker.deadline - time.monotonic())
        answer = require_possible(
            self.assumptions, self.system, self.checker.verifier, left, self.source
        )
        return answer.verdict is Verdict.FAIL

    # --- vacuity -------------------------------------------------------------------------------

    def _look_for_vacuity(self, findings: list[Finding]) -> None:
        passed = [Passed(f.formula, f.needed) for f in findings]
        found = look_for_vacuity(self.checker, self.robot, passed)
        for finding, vacuity in zip(findings, found, strict=True):
            finding.vacuity = vacuity
