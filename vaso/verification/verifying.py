"""The verb ``verify``: does every behaviour of a plan satisfy every rule of its skill?"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from vaso.dynamics.result import BetweenSamples
from vaso.errors import LabellingError, PlanError, UnsupportedPlanError
from vaso.labels.states import compare_states
from vaso.ltl import Formula, ParsedFormula, parse_with_warnings, to_english
from vaso.plan.explore import Budget, compile_plan
from vaso.plan.model import Plan
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Platform, get_platform
from vaso.skill import Rule, Skill
from vaso.verdict import Counterexample, Problem, SpecResult, Verdict, VerificationResult
from vaso.verification.coverage import measure
from vaso.verification.cuts import explain
from vaso.verification.task import Finding, Task
from vaso.verifiers import Verifier, get_verifier

__all__ = ["OnProgress", "verify"]

OnProgress = Callable[[str, int], None]


def verify(
    skill: Skill | str,
    plan: Plan | str | Path,
    *,
    platform: str | Path | Platform | None = None,
    specs: Sequence[str | Formula | Rule] = (),
    verifier: str | Verifier | None = None,
    budget: Budget | None = None,
    timeout: float = 60.0,
    counterexamples: bool = True,
    between: bool = True,
    coverage: float = 0.0,
    on_progress: OnProgress | None = None,
) -> VerificationResult:
    """Check every rule of a skill on every behaviour of a plan.

    A rule that fails on its own is checked again under the skill's assumptions; a PASS names the
    ones that it needs. A plan that cannot be explored to the end gets a PASS or FAIL only where
    what was explored decides the rule.

    Args:
        skill: The skill, or the name or path of one.
        plan: The plan, its source text, or the path of its file.
        platform: Overrides the skill's platform.
        specs: Formulas to check besides the skill's rules.
        verifier: A verifier or its name; by default direct evaluation, and PyNuSMV for the rest.
        budget: Bounds of the exploration.
        timeout: Seconds for model checking, all rules together.
        counterexamples: Whether to compute counterexamples.
        between: Whether to bound numbers between samples as well.
        coverage: Seconds for finding out which of the plan's lines run, by a second exploration;
            without it, lines that make no call are mostly unknown.
        on_progress: Called now and then with ``exploring`` and the number of states found so far,
            then with ``checking`` and the number of rules.

    Returns:
        One verdict per rule, in the order of the skill, then one per spec. A plan or labelling
        code that is not valid makes every verdict UNSUPPORTED; ``problem`` says what is wrong.

    Raises:
        FormulaError: A spec does not parse.
        SkillError: There is no such skill, or its assumptions are not about sensors, or are
            contradictory.
        PlanError: The plan's file cannot be read.
        PlatformError: There is no such platform.
        VerifierError: There is no such verifier, or it is not installed.
    """
    started = time.perf_counter()
    skill, plan = _skill(skill), _plan(plan)
    robot = get_platform(platform or skill.platform)
    rules = [*map(Checked.rule, skill.rules), *map(Checked.spec, specs)]
    engine = get_verifier(verifier)
    try:
        system = compile_plan(
            plan,
            skill,
            platform=robot,
            formulas=[r.formula for r in rules],
            budget=budget,
            on_states=partial(on_progress, "exploring") if on_progress else None,
        )
    except (PlanError, LabellingError) as error:
        results = tuple(r.undecided(robot, str(error)) for r in rules)
        seconds = time.perf_counter() - started
        return VerificationResult(
            results, seconds=seconds, plan=plan.source, problem=_problem(error)
        )
    if on_progress:
        on_progress("checking", len(rules))
    task = Task(system, skill, robot, engine, timeout, counterexamples)
    findings = task.findings([r.formula for r in rules])
    results = tuple(
        r.decided(robot, f, task.counterexample(f)) for r, f in zip(rules, findings, strict=True)
    )
    inside = _between_samples(task, findings, results) if between else ()
    formulas = [r.formula for r in rules]
    seen = measure(plan, skill, robot, system, formulas, seconds=coverage)
    labels = compare_states(system, robot, [*formulas, *(a.formula for a in skill.assumptions)])
    undecided = any(r.verdict in (Verdict.UNKNOWN, Verdict.UNSUPPORTED) for r in results)
    return VerificationResult(
        specs=results,
        states=len(system.states),
        transitions=system.transitions,
        seconds=time.perf_counter() - started,
        plan=plan.source,
        problem=_incomplete(system) if undecided else None,
        warnings=(*system.warnings, *_remarks(system, undecided)),
        system=system,
        coverage=seen,
        between=inside,
        labels=labels,
    )


def _between_samples(
    task: Task, findings: Sequence[Finding], results: Sequence[SpecResult]
) -> tuple[BetweenSamples, ...]:
    from vaso.dynamics.check import Sampled, between_samples

    pairs = zip(findings, results, strict=True)
    rules = [Sampled(finding.formula, result, finding.needed) for finding, result in pairs]
    return between_samples(task.system, rules, task.robot, task.checker.verifier)


def _skill(skill: Skill | str) -> Skill:
    if isinstance(skill, Skill):
        return skill
    from vaso.skill_file import load_skill

    return load_skill(skill)


def _plan(plan: Plan | str | Path) -> Plan:
    if isinstance(plan, Plan):
        return plan
    return Plan.read(plan) if isinstance(plan, Path) else Plan(source=plan)


def _problem(error: PlanError | LabellingError) -> Problem:
    kind = "unsupported" if isinstance(error, UnsupportedPlanError) else "input"
    return Problem(kind, str(error), error.line if isinstance(error, PlanError) else None)


def _incomplete(system: TransitionSystem) -> Problem | None:
    if system.cut is None:
        return None
    kind = "unknown" if system.cut.supported else "unsupported"
    return Problem(kind, explain(system.cut), system.cut.line)


def _remarks(system: TransitionSystem, undecided: bool) -> list[str]:
    return [] if system.cut is None or undecided else [explain(system.cut)]


@dataclass(frozen=True, slots=True)
class Checked:
    """A formula to check, with its origin."""

    parsed: ParsedFormula
    role: str

    @classmethod
    def rule(cls, rule: Rule) -> Checked:
        return cls(rule.parsed, rule.role)

    @classmethod
    def spec(cls, spec: str | Formula | Rule) -> Checked:
        if isinstance(spec, Rule):
            return cls.rule(spec)
        if isinstance(spec, str):
            return cls(parse_with_warnings(spec), "extra")
        return cls(ParsedFormula(spec, str(spec)), "extra")

    @property
    def formula(self) -> Formula:
        return self.parsed.formula

    def undecided(self, robot: Platform, reason: str) -> SpecResult:
        """The result where there is no system to check."""
        return replace(self._result(robot, Verdict.UNSUPPORTED), reason=reason)

    def decided(
        self, robot: Platform, finding: Finding, counterexample: Counterexample | None
    ) -> SpecResult:
        """The result of a check."""
        return replace(
            self._result(robot, finding.answer.verdict),
            engine=finding.answer.engine,
            seconds=finding.seconds,
            counterexample=counterexample,
            vacuous=finding.vacuity.reason,
            stronger=finding.vacuity.stronger,
            unchecked=finding.vacuity.unchecked,
            assumptions=tuple(rule.text for rule in finding.needed),
            reason=finding.answer.reason,
        )

    def _result(self, robot: Platform, verdict: Verdict) -> SpecResult:
        return SpecResult(
            spec=self.parsed.text,
            formula=str(self.formula),
            english=to_english(self.formula, robot.phrases),
            role=self.role,
            verdict=verdict,
            warnings=self.parsed.warnings,
        )
