"""The loss of a skill: draw a plan from its texts, verify it, turn the result into a gradient."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from vaso.errors import ModelError, VasoError
from vaso.feasibility import FeasibilityResult, check, satisfiable
from vaso.gradient import find_repair, textual_gradient
from vaso.gradient.model import Edit, Level, TextualGradient
from vaso.lm import explain
from vaso.ltl import Unary, parse, propositions, variables
from vaso.memo import default_memo, verify_remembered
from vaso.modules.symbolic import SymbolicPlanner
from vaso.optimizers.alignment import Alignment
from vaso.optimizers.base import Case, LossValue
from vaso.optimizers.completion import Purpose, completion, purpose, purpose_of_text
from vaso.optimizers.once import Once
from vaso.optimizers.parameters import Parameters, digest
from vaso.plan import Budget, compile_plan
from vaso.plan.model import Plan
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Platform, get_platform
from vaso.skill import Skill
from vaso.verdict import VerificationResult, score_of

Planner = Callable[[Skill, str], Any]
"""Gives a :class:`~vaso.plan.Plan`, or a ``dspy.Prediction`` with one in its field ``plan``."""
Verify = Callable[[Skill, Plan], VerificationResult]


KEPT_SYSTEMS = 16
SECONDS = 20.0
"""Bound for exploring a plan, and for checking it."""


@dataclass(frozen=True)
class _Judged:
    """A plan with what was found out about it."""

    result: VerificationResult
    purpose: Purpose | None
    labels: Alignment


class SkillLoss:
    """Scores the texts of a skill on a task.

    Syntax gate, feasibility gate, plan, verification, gradient: the first that fails decides. No
    plan is drawn twice for the same texts and task, no plan is verified twice under the same rules
    and labels, and no contract is checked twice.
    """

    def __init__(
        self,
        skill: Skill,
        planner: Planner,
        *,
        level: Level | str = Level.BLAME,
        verify: Verify | None = None,
        check: Callable[[Skill], FeasibilityResult] = check,
    ) -> None:
        """Set up.

        Args:
            skill: The skill at the start: its plans tell what a plan for each task should do.
            planner: Writes the plan for a skill and a task prompt.
            level: How much the gradients say.
            verify: Verifies a plan of a skill; by default as :func:`vaso.verify`, with the user's
                memo and with bounds on the time, since an edit can make a plan grow without end.
            check: Checks the feasibility of a skill.
        """
        self.planner, self.level = planner, Level(level)
        self.initial = Parameters(skill)
        self.platform = get_platform(skill.platform)
        self.verifications = 0
        self._verify, self._check = verify or _verify_in_time, check
        self._plans: Once[str] = Once()
        self._judged: Once[_Judged] = Once()
        self._conflicts: Once[str] = Once()
        self._repairs: Once[Edit | None] = Once()
        self._systems: dict[str, TransitionSystem | None] = {}
        self._lock = threading.Lock()

    def __call__(self, params: Parameters, case: Case) -> LossValue:
        """Evaluate texts on a case.

        Raises:
            ModelError: The planner's language model does not answer.
        """
        if problems := params.problems():
            return LossValue.malformed(problems, self.level)
        try:
            if conflict := self._conflict(params.skill):
                return LossValue.malformed({"local_rule": conflict}, self.level)
            return self._value(params, case, self._plan(params, case))
        except VasoError as error:
            if isinstance(error, ModelError):
                raise
            return LossValue.malformed({"plan_template": str(error)}, self.level)

    # -- plans that were drawn can be taken along ---------------------------------------------

    def state(self) -> dict[str, Any]:
        """What a checkpoint keeps: the plans, which a language model may have been paid for."""
        return {"plans": dict(self._plans.values)}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Take up the state of an earlier run."""
        self._plans.values.update(state.get("plans", {}))

    # -- stages --------------------------------------------------------------------------------

    def _conflict(self, skill: Skill) -> str:
        """What is wrong with the contract itself; empty where nothing is, as far as is known."""
        return self._conflicts.get(_key(skill, ""), lambda: self._find_conflict(skill))

    def _find_conflict(self, skill: Skill) -> str:
        found = self._check(skill)
        if found.hopeless:
            return found.feedback or found.summary()
        return self._emptiness(skill)

    def _emptiness(self, skill: Skill) -> str:
        """Why a new local rule is none: it must not be bought by saying nothing."""
        before = self.initial.origin
        if skill.local_rules == before.local_rules:
            return ""
        if before.local_rules and not skill.local_rules:
            return "without a local rule the skill says nothing of what it is for"
        for rule in skill.local_rules:
            others = [r.formula for r in (*skill.global_rules, *skill.assumptions)]
            if satisfiable([*others, Unary("!", rule.formula)]).sat is False:
                return f"{rule} says nothing that the global rules do not say"
        if self._moves(before) and not self._moves(skill):
            return "a robot that always rests keeps the local rule; the rule before asked for more"
        return ""

    def _moves(self, skill: Skill) -> bool:
        """True where a robot that rests for ever can violate a local rule."""
        others = [r.formula for r in (*skill.global_rules, *skill.assumptions)]
        rules = [r.formula for r in skill.local_rules]
        names = {n for f in (*others, *rules) for n in (*propositions(f), *variables(f))}
        rest = [parse(f"G ({fact})") for name, fact in _at_rest(self.platform) if name in names]
        return any(
            satisfiable([*others, *rest, Unary("!", rule)]).sat is not False for rule in rules
        )

    def _plan(self, params: Parameters, case: Case) -> Plan:
        key = digest([params.key, case.task])
        source = self._plans.get(key, lambda: self._draw(params.skill, case).source)
        return Plan(source=source, task=case.task)

    def _draw(self, skill: Skill, case: Case) -> Plan:
        try:
            return _plan_of(self.planner(skill, case.task))
        except VasoError:
            raise
        except Exception as error:
            problem = explain(error)
            if isinstance(problem, ModelError):
                raise problem from error
            raise VasoError(f"the planner failed: {type(error).__name__}: {error}") from error

    def _judge(self, skill: Skill, plan: Plan) -> _Judged:
        """The verdict on a plan. It is kept without the transition system, which may be large."""
        key = _key(skill, plan.source)

        def judge() -> _Judged:
            result = self._verify(skill, plan)
            system = result.system
            self._remember(key, system, verified=True)
            return _Judged(
                replace(result, system=None),
                purpose(system, self.platform) if system else None,
                Alignment(skill, result, self.platform),
            )

        return self._judged.get(key, judge)

    def with_system(self, params: Parameters, value: LossValue) -> LossValue:
        """A value whose result has its transition system, for those who look closer."""
        if value.result is None or value.result.system is not None:
            return value
        return replace(value, result=self._explored(params.skill, value.result))

    def _explored(self, skill: Skill, result: VerificationResult) -> VerificationResult:
        key = _key(skill, result.plan)
        if key in self._systems:
            return replace(result, system=self._systems[key])
        try:
            system = compile_plan(result.plan, skill, platform=self.platform)
        except VasoError:
            system = None
        self._remember(key, system)
        return replace(result, system=system)

    def _remember(
        self, key: str, system: TransitionSystem | None, *, verified: bool = False
    ) -> None:
        with self._lock:
            self.verifications += verified
            self._systems[key] = system
            while len(self._systems) > KEPT_SYSTEMS:
                self._systems.pop(next(iter(self._systems)))

    def _reference(self, case: Case) -> tuple[Purpose, frozenset[str]]:
        """What the first plan for a case can do, and where its labels were wrong already."""
        plan = self._plan(self.initial, case)
        judged = self._judge(self.initial.skill, plan)
        return judged.purpose or purpose_of_text(plan.source, self.platform), judged.labels.wrong

    def _value(self, params: Parameters, case: Case, plan: Plan) -> LossValue:
        skill = params.skill
        judged = self._judge(skill, plan)
        reference, accepted = self._reference(case)
        if message := judged.labels.told(judged.labels.wrong - accepted):
            return LossValue.malformed({"labelling_code": message}, self.level)
        kept, lost = completion(reference, judged.purpose)
        result, safety = judged.result, judged.labels.safety(judged.result)
        return LossValue(
            score=score_of(bool(result) and safety == result.safety, safety),
            make_gradient=lambda: self._gradient(result, params, case),
            feedback=judged.labels.feedback(_feedback(result)),
            result=result,
            plan=plan.source,
            completion=kept,
            lost=lost,
        )

    def _gradient(
        self, result: VerificationResult, params: Parameters, case: Case
    ) -> TextualGradient:
        search = self.level is Level.REPAIR and not result
        edit = self._repair(params, case) if search else None
        explored = self._explored(params.skill, result)
        return textual_gradient(explored, skill=params.skill, level=self.level, repair=edit)

    def _repair(self, params: Parameters, case: Case) -> Edit | None:
        """A verified edit of the template; its plans are the symbolic planner's, which is free."""
        skill, draw = params.skill, SymbolicPlanner()

        def search() -> Edit | None:
            return find_repair(
                skill,
                params["plan_template"],
                verify=lambda plan: self._judge(skill, Plan(source=plan)).result,
                plans=lambda text: [draw(_with_template(skill, text), case.task).source],
                platform=self.platform,
            )

        return self._repairs.get(digest([params.key, case.task]), search)


def _at_rest(platform: Platform) -> Iterator[tuple[str, str]]:
    """What is true of a robot at rest: the propositions and a formula for each."""
    dynamics = platform.dynamics
    for name, value in dynamics.truth(dynamics.initial()).items():
        if isinstance(value, bool):
            yield name, name if value else f"!{name}"
        else:
            yield name, f"{name} = {value!r}"


def _key(skill: Skill, plan: str) -> str:
    rules = [f"{r.role}:{r.text}" for r in (*skill.rules, *skill.assumptions)]
    return digest([*rules, skill.labelling_code, plan])


def _verify_in_time(skill: Skill, plan: Plan) -> VerificationResult:
    return verify_remembered(
        skill,
        plan,
        memo=default_memo(),
        with_system=True,
        timeout=SECONDS,
        budget=Budget(seconds=SECONDS),
        between=False,
    )


def _plan_of(answer: Any) -> Plan:
    """The plan, also where a dspy module wraps it in a prediction."""
    return answer if isinstance(answer, Plan) else answer.plan


def _with_template(skill: Skill, text: str) -> Skill:
    return skill.with_parameters({"plan_template": text})


def _feedback(result: VerificationResult) -> dict[str, str]:
    """What is known to be wrong, by text."""
    if result.problem is not None:
        return {"plan_template": result.problem.message}
    violated = [f"violates {s.spec}" for s in result.failures]
    return {"plan_template": "\n".join(violated)} if violated else {}
