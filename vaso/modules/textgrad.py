"""For TextGrad programs: the verifier as a loss, and any ``dspy.LM`` as an engine.

Import this module before ``textgrad``, which otherwise makes a folder ``logs`` in the working
folder; see ``docs/textgrad.md`` for a whole program.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal, get_args

from vaso.errors import OptimizerError
from vaso.gradient.model import Level
from vaso.lm import get_lm
from vaso.modules.asking import first_text
from vaso.modules.judging import Judge, TextName, numbered, objective, verdict_text
from vaso.modules.wording import rules_text
from vaso.optimizers.base import LossValue
from vaso.optimizers.loss import Planner
from vaso.optimizers.textgrad_setup import import_textgrad
from vaso.skill import Skill
from vaso.verdict import VerificationResult

import_textgrad()

import textgrad as tg  # noqa: E402
from textgrad.autograd.string_based_ops import StringBasedFunction  # noqa: E402

__all__ = ["DspyEngine", "VerifierLoss"]

Backward = Literal["verifier", "engine"]

VERIFIES = (
    "Explores every behaviour of a robot's plan and model-checks each rule of its skill. The plan "
    "must satisfy all of them."
)
OUTPUT_ROLE = "the verdict of a model checker on a robot's plan"


class DspyEngine(tg.EngineLM):  # type: ignore[misc]
    """A TextGrad engine that asks a ``dspy.LM``: with its temperature, cache, retries and usage.

    Attributes:
        lm: The model.
        model_string: Its name.
    """

    def __init__(self, lm: Any = None, **options: Any) -> None:
        """Set up.

        Args:
            lm: A ``dspy.LM`` or its name, such as ``openai/gpt-4o-mini``; by default the one that
                ``VASO_LM`` or ``dspy.configure`` names.
            options: Passed to ``dspy.LM`` where a name is given (``temperature``, ``cache``, …).

        Raises:
            ModelError: No model is given, or the name is not one.
        """
        self.lm = get_lm(lm, **options)
        self.model_string = str(self.lm.model)

    def __call__(self, prompt: Any, system_prompt: str | None = None, **options: Any) -> str:
        """As :meth:`generate`."""
        return self.generate(prompt, system_prompt, **options)

    def generate(self, prompt: Any, system_prompt: str | None = None, **options: Any) -> str:
        """Ask the model.

        Args:
            prompt: A text, or a list of texts.
            system_prompt: Goes in front of the prompt, since a ``dspy.LM`` takes one text.
            options: Passed to the model (``temperature``, ``max_tokens``, …).

        Returns:
            The reply's text, empty if it has none.
        """
        parts = [prompt] if isinstance(prompt, str) else list(prompt)
        if not all(isinstance(part, str) for part in parts):
            raise OptimizerError("a DspyEngine takes text only", expected="a prompt without images")
        text = "\n\n".join([*([system_prompt] if system_prompt else []), *parts])
        return first_text(self.lm(text, **options))


class VerifierLoss(StringBasedFunction):  # type: ignore[misc]
    """The verifier as a TextGrad loss, for a plan or for a text of a skill.

    Calling it on a variable gives the loss, a variable whose value is the verdict; ``backward()``
    gives the variable its textual gradient, built from a counterexample.

    Attributes:
        score: Of the last text: safety, the fraction of the rules that are proved; 0 where the
            plan gives up what the skill's first plan could do. 1.0 means verified.
        result: Of the last text: the verification result, truthy if every rule passes; None where
            the text is malformed.
        verified: True if every rule was proved of the last text, and its task is not given up.
    """

    def __init__(
        self,
        skill: Skill | str | Path,
        *,
        text: TextName = "plan",
        planner: Planner | None = None,
        level: Level | str = Level.BLAME,
        backward: Backward = "verifier",
    ) -> None:
        """Set up.

        Args:
            skill: The skill, or the name or file of one; its rules are verified, and its other
                texts are taken.
            text: What the variables are: ``plan``, ``plan_template``, ``labelling_code`` or
                ``local_rule``.
            planner: Draws the plan from the skill's texts, where the variable is not a plan; by
                default the symbolic planner, which needs no model.
            level: How much the gradient says: ``verdict``, ``trace``, ``blame`` or ``repair``.
            backward: Who writes the gradient. ``verifier``: it is the counterexample itself,
                which is exact and asks no model. ``engine``: the backward engine comments on the
                counterexample, as for TextGrad's own functions.

        Raises:
            OptimizerError: There is no such text, or no such way to write gradients.
            SkillError: There is no such skill.
        """
        if backward not in get_args(Backward):
            raise OptimizerError(
                f"nobody called '{backward}' writes gradients", expected="'verifier' or 'engine'"
            )
        self._judge = Judge(skill, text=text, planner=planner, level=level)
        super().__init__(self._verdict, purpose(self._judge.skill, text))
        self._text, self._writer, self._task = text, backward, ""
        self._value: LossValue | None = None

    # -- what is known of the last text --------------------------------------------------------

    @property
    def score(self) -> float:
        """Safety of the last text, in [0, 1]."""
        return objective(self._last)

    @property
    def result(self) -> VerificationResult | None:
        """Verification result of the last text."""
        return self._last.result

    @property
    def verified(self) -> bool:
        """True if the last text is verified."""
        return self._last.verified and not self._last.lost

    @property
    def _last(self) -> LossValue:
        if self._value is None:
            raise OptimizerError("nothing was verified yet", hint="call the loss on a variable")
        return self._value

    # -- forward and backward ------------------------------------------------------------------

    def forward(self, variable: tg.Variable, task: str = "") -> tg.Variable:
        """Verify a variable's text.

        Args:
            variable: The plan, or the skill's text.
            task: The task prompt that a plan is drawn for, where the variable is not a plan.

        Returns:
            The loss. Its value is the verdict with the gradient and the plan; ``score`` and
            ``result`` are those of this text.

        Raises:
            ModelError: The planner's model does not answer.
            OptimizerError: This is not a variable.
        """
        if not isinstance(variable, tg.Variable):
            raise OptimizerError(f"{variable!r} is no variable", expected="a textgrad.Variable")
        self._value = self._judge(variable.get_value(), task)
        loss = super().forward({self._text: variable}, response_role_description=OUTPUT_ROLE)
        loss.score, loss.result, loss.gradient = self.score, self.result, verdict_text(self._last)
        return loss

    def _verdict(self, **variables: tg.Variable) -> str:
        value = self._last
        head = "PASS" if self.verified else "FAIL"
        parts = [f"{head}: safety {self.score:.2f}", verdict_text(value)]
        if value.plan:
            parts.append(f"The plan:\n{numbered(value.plan)}")
        return "\n\n".join(parts)

    def backward(
        self, response: tg.Variable, function_purpose: str, inputs: Any, backward_engine: Any
    ) -> None:
        """Give the variable its gradient; TextGrad calls it."""
        if self._writer == "engine" or response.get_gradient_text().strip():
            super().backward(response, function_purpose, inputs, backward_engine)
            return
        for variable in inputs.values():
            if variable.requires_grad:
                _add_gradient(variable, response, function_purpose)


def purpose(skill: Skill, text: str) -> str:
    """What models get to read about the loss: the rules, and what a plan may call.

    Args:
        skill: The skill.
        text: The name of the text that is optimized.
    """
    rules = rules_text((*skill.rules, *skill.assumptions), skill.platform)
    parts = [f"{VERIFIES} The rules:\n{rules}"]
    if text in ("plan", "plan_template"):
        parts.append(f"A plan may call these functions, and no others:\n{skill.labelling_code}")
    return "\n\n".join(parts)


def _add_gradient(variable: tg.Variable, loss: tg.Variable, told: str) -> None:
    """As TextGrad does it, with the verifier's words in place of a model's."""
    role = variable.get_role_description()
    gradient = tg.Variable(loss.gradient, role_description=f"feedback to {role}")
    variable.gradients.add(gradient)
    variable.gradients_context[gradient] = {
        # TextGrad shows the optimizer no more than the first and last words of a long variable.
        "context": f"{told}\n\nThe text:\n{numbered(variable.get_value())}",
        "response_desc": loss.get_role_description(),
        "variable_desc": role,
    }
    gradient._reduce_meta.extend(loss._reduce_meta)
    variable._reduce_meta.extend(loss._reduce_meta)
