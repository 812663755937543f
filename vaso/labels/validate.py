"""The verb ``validate_labels``: is a skill's labelling code right about the robot?"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from vaso.errors import LabellingError, VasoError
from vaso.labels.judge import Difference, Judge
from vaso.labels.result import LabelComparison, LabelReport, LabelStatus, LabelWitness
from vaso.labels.sampling import Sample, sample
from vaso.labels.sandbox import Sandbox
from vaso.labels.search import Found, Search
from vaso.labels.shorten import shorten
from vaso.labels.space import Space
from vaso.labels.states import compare_states
from vaso.labels.symbolic import Proofs, prove
from vaso.labels.truth import Rules, sensor_domain
from vaso.labels.witness import witness_of
from vaso.ltl import Formula
from vaso.plan import Budget, compile_plan
from vaso.plan.model import Plan
from vaso.platforms import Platform, get_platform
from vaso.skill import Skill

__all__ = ["FULL", "QUICK", "Effort", "validate_labels"]


@dataclass(frozen=True, slots=True)
class Effort:
    """How hard to look.

    Attributes:
        trials: Random trials.
        examples: Trials that hypothesis makes up in each search.
        proof_seconds: Time for proofs.
        seconds: Time for trials and searches.
        template: Whether the states of a plan are compared too.
    """

    trials: int
    examples: int
    proof_seconds: float
    seconds: float
    template: bool


QUICK = Effort(trials=300, examples=30, proof_seconds=2.0, seconds=6.0, template=False)
FULL = Effort(trials=3_000, examples=200, proof_seconds=10.0, seconds=15.0, template=True)
CHECKED = 200
"""Random trials of what is proved already: proofs are over the reals, the robot computes in floats.
"""
PLAN_BUDGET = Budget(seconds=10.0)


def validate_labels(
    skill: Skill | str,
    platform: str | Path | Platform | None = None,
    *,
    plan: Plan | str | None = None,
    specs: Sequence[Formula] = (),
    effort: Effort = FULL,
    seed: int = 0,
) -> LabelReport:
    """Compare a skill's labelling code with the platform's true propositions.

    By proof with an SMT solver where the code is arithmetic, by independent random runs and a
    property-based search in the sandbox for the rest, and in every state of a plan.

    Args:
        skill: The skill, or the name or path of one.
        platform: Overrides the skill's platform.
        plan: A plan whose states are compared; by default the template, where ``effort`` says so.
        specs: Formulas that verdicts are wanted for, besides the skill's rules.
        effort: How hard to look: ``QUICK`` or ``FULL``.
        seed: Equal seeds look alike.

    Returns:
        One comparison for each proposition that the labelling code defines or a rule mentions,
        truthy only where labels were compared and none that a rule mentions is wrong. Labelling
        code that does not run leaves them not comparable; it raises nothing.

    Raises:
        SkillError: There is no such skill.
        PlatformError: There is no such platform.
    """
    started = time.perf_counter()
    skill = _skill(skill)
    robot = get_platform(platform or skill.platform)
    formulas = [r.formula for r in (*skill.rules, *skill.assumptions)]
    rules = Rules((*formulas, *specs))
    try:
        comparisons = _Validation(skill, robot, rules, effort, seed).comparisons()
    except LabellingError as error:
        comparisons = _broken(robot, rules, str(error))
    report = LabelReport(skill.name, comparisons)
    if plan is not None or (effort.template and skill.plan_template.strip()):
        report = _with_plan(report, skill, robot, rules, plan)
    return replace(report, seconds=time.perf_counter() - started)


def _skill(skill: Skill | str) -> Skill:
    if isinstance(skill, Skill):
        return skill
    from vaso.skill_file import load_skill

    return load_skill(skill)


def _with_plan(
    report: LabelReport, skill: Skill, robot: Platform, rules: Rules, plan: Plan | str | None
) -> LabelReport:
    """The report with what the states of a plan show."""
    try:
        system = compile_plan(
            plan if plan is not None else skill.plan_template,
            skill,
            platform=robot,
            formulas=rules.formulas,
            budget=PLAN_BUDGET,
        )
    except VasoError as error:
        return replace(
            report, in_plan=LabelReport(gap=f"the plan cannot be explored: {error.message}")
        )
    found = compare_states(system, robot, rules.formulas)
    wrong = {c.name: c for c in found.wrong}
    merged = [
        wrong[c.name] if c.name in wrong and c.status is not LabelStatus.DIFFERS else c
        for c in report.comparisons
    ]
    return replace(report, comparisons=tuple(merged), in_plan=found)


def _broken(robot: Platform, rules: Rules, why: str) -> tuple[LabelComparison, ...]:
    """What is known where the labelling code does not run."""
    known = {p.name for p in robot.propositions}
    return tuple(
        LabelComparison(
            name, LabelStatus.INCOMPARABLE, detail=why, mentioned=True, own=name not in known
        )
        for name in sorted(rules.names)
    )


class _Validation:
    """One validation.

    Args:
        skill: The skill.
        robot: Its platform.
        rules: What is verified.
        effort: How hard to look.
        seed: For all that is random.
    """

    def __init__(
        self, skill: Skill, robot: Platform, rules: Rules, effort: Effort, seed: int
    ) -> None:
        self.skill, self.robot, self.rules = skill, robot, rules
        self.effort, self.seed = effort, seed
        self.deadline = 0.0

    def comparisons(self) -> tuple[LabelComparison, ...]:
        """The outcome, by proposition.

        Raises:
            LabellingError: The labelling code does not run.
        """
        names = [p.name for p in self.robot.propositions]
        with Sandbox(self.skill, self.robot, [*names, *sorted(self.rules.names)]) as sandbox:
            functions = sandbox.functions
            defined = {*functions.actions, *functions.labels, *functions.broken}
            proofs = prove(self.skill, self.robot, functions, self.effort.proof_seconds)
            samples, witnesses = self._tried(sandbox, proofs)
        listed = [n for n in names if n in defined or n in self.rules.names]
        others = sorted(self.rules.names - set(names))
        found = {
            name: self._comparison(name, defined, proofs, samples, witnesses)
            for name in (*listed, *others)
        }
        broken = {n: self._at_rest(n, why) for n, why in functions.broken.items() if n in listed}
        return tuple((found | broken).values())

    # -- runs ------------------------------------------------------------------------------------

    def _tried(
        self, sandbox: Sandbox, proofs: Proofs
    ) -> tuple[dict[str, Sample], dict[str, LabelWitness]]:
        """Random runs, suspicions of the solver, and a search for what they did not show."""
        self.deadline = time.monotonic() + self.effort.seconds
        judge, space = Judge(self.robot, sandbox.functions), Space(sandbox, self.rules.formulas)
        names = {*sandbox.functions.actions, *sandbox.functions.labels} - proofs.proved.keys()
        count = self.effort.trials if names else min(CHECKED, self.effort.trials)
        samples = sample(
            sandbox,
            space,
            judge,
            self.rules,
            count=count,
            seed=self.seed,
            seconds=self.effort.seconds,
        ).samples
        found = {n: one.example for n, one in samples.items() if one.example is not None}
        for trial, moments in zip(proofs.suspects, sandbox.run(proofs.suspects), strict=True):
            for difference in judge(moments).differences:
                found.setdefault(difference.name, (trial, difference))
        search = Search(sandbox, space, judge, self.seed)
        while further := self._find(search, names - found.keys()):
            found[further[1].name] = further
        for name in found.keys() - samples.keys():
            samples[name] = Sample()
        return samples, {n: self._witness(sandbox, judge, example) for n, example in found.items()}

    def _witness(self, sandbox: Sandbox, judge: Judge, example: Found) -> LabelWitness:
        """The simplest witness that tells as much as an example."""
        name, rank = example[1].name, example[1].rank(self.rules)

        def as_telling(difference: Difference) -> bool:
            return difference.name == name and difference.rank(self.rules) <= rank

        simplest = shorten(sandbox, judge, *example, as_telling)
        return witness_of(*simplest, self.robot, self.rules)

    def _find(self, search: Search, names: set[str]) -> Found | None:
        """A difference in some propositions, if there is time to look for one."""
        left = self.deadline - time.monotonic()
        if not names or left <= 0:
            return None
        return search.find(lambda d: d.name in names, examples=self.effort.examples, seconds=left)

    # -- outcomes --------------------------------------------------------------------------------

    def _comparison(
        self,
        name: str,
        defined: set[str],
        proofs: Proofs,
        samples: Mapping[str, Sample],
        witnesses: Mapping[str, LabelWitness],
    ) -> LabelComparison:
        mentioned, one = name in self.rules.names, samples.get(name, Sample())
        counted = LabelComparison(
            name,
            LabelStatus.SAMPLED,
            "sampling",
            samples=one.trials,
            mismatches=one.failures,
            bounds=one.bounds,
            mentioned=mentioned,
        )
        if witness := witnesses.get(name):
            return replace(counted, status=LabelStatus.DIFFERS, witness=witness)
        if name in proofs.proved:
            detail = proofs.proved[name]
            return replace(counted, status=LabelStatus.PROVED, means="smt", detail=detail)
        if name not in defined and self.robot.proposition(name) is not None:
            detail = "the code does not define it; the platform's own meaning is used"
            return LabelComparison(
                name, LabelStatus.PROVED, "definition", detail, mentioned=mentioned
            )
        return counted if one.trials else self._incomparable(name, mentioned)

    def _incomparable(self, name: str, mentioned: bool) -> LabelComparison:
        spec, robot = self.robot.proposition(name), self.robot.name
        if spec is None:
            why = f"platform {robot} does not know it; it means what the code says"
        elif spec.kind == "observation" and not sensor_domain(spec, self.robot):
            why = f"platform {robot} names no sensor for it"
        else:
            why = f"the dynamics of platform {robot} say nothing of it"
        return LabelComparison(
            name, LabelStatus.INCOMPARABLE, detail=why, mentioned=mentioned, own=spec is None
        )

    def _at_rest(self, name: str, why: str) -> LabelComparison:
        """A label that cannot even be computed on the robot at rest."""
        truth = self.robot.dynamics.truth(self.robot.dynamics.initial())
        mentioned = name in self.rules.names
        if not why.startswith("the code ") or name not in truth:
            return LabelComparison(name, LabelStatus.INCOMPARABLE, detail=why, mentioned=mentioned)
        says, situation = why.removeprefix("the code "), "at rest, before the first command"
        witness = LabelWitness(name, says, truth[name], situation)
        return LabelComparison(
            name, LabelStatus.DIFFERS, "sampling", witness=witness, mentioned=mentioned
        )
