"""For AdalFlow programs: a skill as a component with trainable texts, and the verifier as its loss.

The texts of a skill are peer PROMPT parameters; a component draws a plan from them, and the
verifier is the loss. The counterexample is the gradient at the plan as it is, without a model that
retells it; from the plan to each text the backward engine is asked, as AdalFlow does.

Import this module before ``adalflow``, which otherwise wants to download a tokenizer; see
``docs/adalflow.md`` for a whole program.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from vaso.errors import OptimizerError
from vaso.gradient.model import Level
from vaso.modules.judging import Judge, objective, verdict_text
from vaso.modules.symbolic import SymbolicPlanner
from vaso.optimizers.adalflow_setup import import_adalflow
from vaso.optimizers.base import Case, LossValue
from vaso.optimizers.loss import Planner, SkillLoss
from vaso.optimizers.order import Bag, stable_hash
from vaso.optimizers.parameters import DEFAULT_TRAINABLE, ROLES, Parameters
from vaso.skill import ParameterName, Skill
from vaso.skill_file import load_skill

import_adalflow()

import adalflow as adal  # noqa: E402
from adalflow.core.types import GeneratorOutput  # noqa: E402
from adalflow.optim.gradient import Gradient, GradientContext  # noqa: E402
from adalflow.optim.parameter import OutputParameter  # noqa: E402
from adalflow.optim.text_grad.text_loss_with_eval_fn import EvalFnToTextLoss  # noqa: E402

from vaso.optimizers.adalflow_parts import DspyClient, TextOptimizer  # noqa: E402

__all__ = ["DrawnPlan", "DspyClient", "SkillComponent", "TextOptimizer", "VerifierLoss"]

Evaluate = Callable[[Mapping[str, str], Case], LossValue]

ERROR_THRESHOLD = 0.9
"""AdalFlow's default: no gradient is computed for a sample that scores above it."""

GOAL = "a plan that satisfies every rule"
LOSS = "Fraction of the temporal-logic rules that a model checker proves of the plan."
PLANNING = (
    "A planner writes a Python plan for the task from the skill's plan template, using only the "
    "functions of its labelling code. The plan is then model-checked."
)
WHOLE_TEXT = "Give the whole new value, ready to be used: Python source or LTL formulas alone."


class DrawnPlan(str):
    """A plan's text, with what the verifier says about it under the texts it was drawn from.

    Attributes:
        value: The loss value; None for a text of which nothing is known.
    """

    value: LossValue | None

    def __new__(cls, text: str, value: LossValue | None = None) -> DrawnPlan:
        """Make one."""
        made = super().__new__(cls, text)
        made.value = value
        return made


# -- parameters in a fixed order -------------------------------------------------------------------


def _hash(parameter: Any) -> int:
    """Hash of what a parameter is, not of its address: AdalFlow keeps parameters in sets."""
    return int(parameter.order)


class TextParameter(adal.Parameter):  # type: ignore[misc]
    """A skill's text. Its gradients keep their order, so that prompts are the same in every run."""

    __hash__ = _hash

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(param_type=adal.ParameterType.PROMPT, **kwargs)
        self.order = stable_hash(self.name)
        self.reset_gradients()

    def reset_gradients(self) -> None:
        """Forget the gradients."""
        self.gradients = Bag()

    def sort_gradients(self) -> None:
        """They are in order."""


class _Given(adal.Parameter):  # type: ignore[misc]
    """What a planner gets besides the texts."""

    __hash__ = _hash

    def __init__(self, name: str, role: str, data: str, of: str) -> None:
        kind = adal.ParameterType.INPUT
        super().__init__(name=name, role_desc=role, data=data, requires_opt=False, param_type=kind)
        self.order = stable_hash(name, of)


class _Output(OutputParameter):  # type: ignore[misc]
    """What a component gives."""

    __hash__ = _hash


def _instable_hash(output: Any) -> Any:
    """An output parameter that AdalFlow has just made, with a hash that is the same in each run."""
    output.__class__ = _Output
    output.order = stable_hash(output.name, output.data_id)
    return output


# -- the skill -------------------------------------------------------------------------------------


class SkillComponent(adal.GradComponent):  # type: ignore[misc]
    """A skill with its texts as parameters. Called with a task, it draws a plan.

    In evaluation mode a call gives a ``GeneratorOutput`` whose ``data`` is the plan's text; in
    training mode, a parameter with it. Without a backward engine the verifier's words go to the
    texts as they are, and no model is asked.
    """

    def __init__(
        self,
        skill: Skill | str | Path,
        *,
        planner: Planner | None = None,
        level: Level | str = Level.BLAME,
        trainable: Iterable[ParameterName] = DEFAULT_TRAINABLE,
        evaluate: Evaluate | None = None,
    ) -> None:
        """Set up.

        Args:
            skill: A skill, the name of a shipped one (its faulty first version is taken, as by
                :func:`vaso.optimize`), or a file.
            planner: Writes the plan for a skill and a task prompt; by default the symbolic
                planner, which needs no model.
            level: How much the gradients say: ``verdict``, ``trace``, ``blame`` or ``repair``.
            trainable: The texts that may change.
            evaluate: Gives the loss value of texts on a case, in place of planner and level.

        Raises:
            SkillError: The skill cannot be read.
            OptimizerError: A text that there is not.
        """
        super().__init__(desc=PLANNING)
        origin = skill if isinstance(skill, Skill) else load_skill(skill, version="initial")
        self._start = Parameters(origin, trainable=trainable)
        self._evaluate = evaluate or _evaluation(origin, planner, level)
        for name, text in self._start.items():
            setattr(self, name, _text_parameter(name, text, self._start))
        for one in self.parameters():
            one.peers = [p for p in self.parameters() if p is not one]  # a set has no fixed order

    @property
    def texts(self) -> dict[str, str]:
        """The texts as they are now, by name."""
        return {name: p.data for name, p in self.named_parameters(recursive=False)}

    @property
    def skill(self) -> Skill:
        """The skill with the texts as they are now.

        Raises:
            SkillError: The local rule does not parse.
        """
        return self._start.replace(self.texts).skill

    def call(self, task: str, id: str | None = None, rules: str = "", **texts: str) -> Any:
        """Draw a plan.

        Args:
            task: The task prompt.
            id: The sample's id, which AdalFlow's trainer compares.
            rules: There for models that read the graph.
            texts: The texts to draw it from; by default as they are now.

        Raises:
            ModelError: The planner's model does not answer.
        """
        value = self._evaluate(texts or self.texts, Case(str(task)))
        return GeneratorOutput(
            id=id, data=DrawnPlan(value.plan, value), raw_response=value.plan or value.error
        )

    def forward(self, task: str, id: str | None = None) -> Any:
        """Draw a plan as a parameter that gradients flow through.

        Args:
            task: The task prompt.
            id: The sample's id.
        """
        sample = id or str(task)
        rules = "\n".join(r.text for r in self._start.origin.global_rules)
        plan = super().forward(
            id=sample,
            task=_Given("task", "What the robot shall do", str(task), sample),
            rules=_Given("rules", "Global rules", rules, sample),
            **dict(self.named_parameters(recursive=False)),
        )
        plan.eval_input = plan.data.data
        plan.data_in_prompt = lambda parameter: parameter.data.raw_response
        return _instable_hash(plan)

    def backward(
        self, *, response: Any, id: str | None = None, input_kwargs: Any = None, **_: Any
    ) -> None:
        """Compute the gradient of each text that may change; in the order of their names."""
        for text in sorted(response.predecessors, key=lambda p: str(p.name)):
            text.set_score(response.score)
            if text.requires_opt:
                self._backward_to(text, response, input_kwargs)

    def _backward_to(self, text: Any, response: Any, inputs: Any) -> None:
        said = response.get_gradients_str()
        if response.score > ERROR_THRESHOLD:
            text.add_gradient(_gradient("No noticeable error.", response, text))
            return
        if self.backward_engine is None or self._disable_backward_engine:
            text.add_gradient(_gradient(said, response, text))
            return
        self._backward_through_one_predecessor(
            pred=text,
            kwargs=inputs,
            response=response,
            desc=self.desc,
            backward_engine=self.backward_engine,
            ground_truth=GOAL,
            is_intermediate_node=True,
        )
        latest = next(g for g in text.gradients if g.from_response_id == response.id)
        latest.add_data(f"{latest.data}\nThe verifier says:\n{said}")


def _evaluation(origin: Skill, planner: Planner | None, level: Level | str) -> Evaluate:
    loss, start = SkillLoss(origin, planner or SymbolicPlanner(), level=level), Parameters(origin)
    return lambda texts, case: loss(start.replace(texts), case)


def _text_parameter(name: str, text: str, params: Parameters) -> TextParameter:
    return TextParameter(
        name=name,
        data=text,
        role_desc=ROLES[name],  # type: ignore[index]
        requires_opt=name in params.trainable,
        instruction_to_optimizer=WHOLE_TEXT,
    )


# -- the loss --------------------------------------------------------------------------------------


class VerifierLoss(EvalFnToTextLoss):  # type: ignore[misc]
    """The verifier as an AdalFlow loss: safety is the score, the counterexample the gradient.

    For the plans of a :class:`SkillComponent`, which know the texts that they were drawn from, and
    for the plans of any other component, as text. No model is asked: neither for the score nor for
    the gradient.
    """

    def __init__(
        self, skill: Skill | str | Path | None = None, *, level: Level | str = Level.BLAME
    ) -> None:
        """Set up.

        Args:
            skill: The skill that plans of other components are verified against, or the name or
                file of one.
            level: How much the gradients of those plans say.

        Raises:
            SkillError: There is no such skill.
        """
        self._judge = None if skill is None else Judge(skill, level=level)
        super().__init__(eval_fn=self.safety, eval_fn_desc=LOSS)

    def safety(self, plan: Any) -> float:
        """The score of a plan: the evaluation function for AdalFlow's trainer.

        Args:
            plan: A plan's text, or the output of a component with one.

        Returns:
            Safety, in [0, 1]; 0 where the plan gives up what the skill's first plan could do.
        """
        return objective(self.value(plan))

    def value(self, plan: Any) -> LossValue:
        """All that the verifier says about a plan.

        Args:
            plan: A plan's text, or the output of a component with one.

        Raises:
            OptimizerError: It is no plan, or there is no skill to verify it against.
        """
        text = getattr(plan, "data", plan)
        if isinstance(text, DrawnPlan) and text.value is not None:
            return text.value
        if not isinstance(text, str):
            raise OptimizerError(f"{plan!r} is no plan", expected="a plan's text")
        if self._judge is None:
            raise OptimizerError(
                "it is not known which skill the plan is for", hint="VerifierLoss('drive')"
            )
        return self._judge(text)

    def forward(
        self,
        kwargs: Any,
        response_desc: str | None = None,
        metadata: Any = None,
        id: str | None = None,
        gt: Any = None,
        input: Any = None,
    ) -> Any:
        """Verify a plan.

        Args:
            kwargs: ``{"plan": parameter}``.
            response_desc: What the loss is, for models that read the graph.
            metadata: Passed on.
            id: The sample's id.
            gt: Passed on.
            input: Passed on.
        """
        (plan,) = kwargs.values()
        if plan.eval_input is None:
            plan.eval_input = plan.data
        sample = id or plan.data_id or plan.id
        given = {"plan": plan}
        loss = super().forward(given, response_desc or LOSS, metadata, sample, gt or GOAL, input)
        return _instable_hash(loss)

    def backward(self, response: Any, kwargs: Any, **_: Any) -> None:
        """Give the plan the verifier's words as its gradient."""
        plan = kwargs["plan"]
        plan.set_score(response.data)
        if not plan.check_if_already_computed_gradient_respect_to(response.id):
            said = verdict_text(self.value(plan.eval_input))
            plan.add_gradient(_gradient(said, response, plan))


def _gradient(text: str, response: Any, to: Any) -> Any:
    gradient = Gradient(
        data=text,
        data_id=response.data_id,
        score=response.score,
        from_response=response,
        to_pred=to,
    )
    gradient.add_context(
        GradientContext(
            variable_desc=to.role_desc,
            response_desc=response.role_desc,
            input_output=f"{to.name} -> {response.name}: {response.get_prompt_data()}",
        )
    )
    return gradient
