"""Judge a text for a framework that optimizes texts: verify the plan that it is or leads to."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, get_args

from vaso.errors import OptimizerError
from vaso.gradient import find_repair, textual_gradient
from vaso.gradient.model import Level, TextualGradient
from vaso.modules.symbolic import SymbolicPlanner
from vaso.optimizers.base import Case, LossValue
from vaso.optimizers.loss import SECONDS, Planner, SkillLoss
from vaso.optimizers.once import Once
from vaso.optimizers.parameters import NAMES, Parameters
from vaso.plan import Budget
from vaso.plan.model import Plan
from vaso.skill import Skill
from vaso.skill_file import load_skill
from vaso.verdict import VerificationResult, score_of
from vaso.verification import verify

TextName = Literal["plan", "plan_template", "labelling_code", "local_rule"]


class Judge:
    """Says what is wrong with a text; nothing is verified twice. Safe to use from threads."""

    def __init__(
        self,
        skill: Skill | str | Path,
        *,
        text: TextName = "plan",
        planner: Planner | None = None,
        level: Level | str = Level.BLAME,
    ) -> None:
        """Set up.

        Args:
            skill: The skill, or the name or file of one; its rules are what is verified.
            text: What the text is: a plan, or one of the skill's own texts, which it replaces.
            planner: Draws the plan, where the text is not one. By default the symbolic planner,
                which needs no model.
            level: How much the gradients say.

        Raises:
            OptimizerError: There is no such text.
            SkillError: There is no such skill.
        """
        if text not in get_args(TextName):
            raise OptimizerError(
                f"there is no text '{text}'", expected=f"one of {', '.join(get_args(TextName))}"
            )
        self.skill = skill if isinstance(skill, Skill) else load_skill(skill)
        self.text, self.level = text, Level(level)
        self._loss = SkillLoss(self.skill, planner or SymbolicPlanner(), level=level)
        self._texts = Parameters(self.skill, trainable=NAMES)
        self._known: Once[LossValue] = Once()

    def __call__(self, source: str, task: str = "") -> LossValue:
        """Judge a text.

        Args:
            source: The text.
            task: The task that a plan is drawn for, where the text is not one. Without a task, the
                plan is the template as it stands.

        Raises:
            ModelError: The planner's model does not answer.
        """
        judge = self._judge_plan if self.text == "plan" else self._judge_text
        return self._known.get((source, task), lambda: judge(source, task))

    def _judge_text(self, source: str, task: str) -> LossValue:
        return self._loss(self._texts.replace({self.text: source}), Case(task))

    def _judge_plan(self, source: str, task: str) -> LossValue:
        plan, bounds = Plan(source=source, task=task), Budget(seconds=SECONDS)
        result = verify(self.skill, plan, budget=bounds, timeout=SECONDS)
        return LossValue(
            score=score_of(bool(result), result.safety),
            make_gradient=lambda: self._gradient(result),
            result=result,
            plan=source,
        )

    def _gradient(self, result: VerificationResult) -> TextualGradient:
        search = self.level is Level.REPAIR and not result
        edit = find_repair(self.skill, result.plan, parameter="plan") if search else None
        return textual_gradient(result, skill=self.skill, level=self.level, repair=edit)


def objective(value: LossValue) -> float:
    """One number for frameworks that accept or reject by one: safety, in [0, 1].

    It is 0 where the plan cannot do any more what the skill's first plan for the task could: a
    skill that only stops is safe, and not what anybody wants.
    """
    return 0.0 if value.lost else value.score


def verdict_text(value: LossValue) -> str:
    """What a model gets to read: the gradient, and what the plan cannot do any more."""
    lost = [f"The plan gives up its task: {', '.join(value.lost)}."] if value.lost else []
    return "\n\n".join([value.error or str(value.gradient), *lost])


def numbered(source: str) -> str:
    """A text with the line numbers that gradients refer to."""
    return "\n".join(f"{n:3} | {line}" for n, line in enumerate(source.splitlines(), start=1))
