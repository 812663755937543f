"""A ``dspy.Predict`` that carries a skill: its instructions end with the skill's plan template.

That makes the template a parameter in DSPy's own sense. Optimizers that rewrite instructions
(``dspy.GEPA``, ``dspy.SIMBA``, ``dspy.MIPROv2``, ``dspy.COPRO``) rewrite the template, those that
choose demonstrations give the model examples of plans, and what they change is saved and loaded
with the program. Labelling code and rules are not instructions: they are inputs, because they say
what is true of the robot and what is asked of the plan.
"""

from __future__ import annotations

import ast
import re
from contextlib import AbstractContextManager
from typing import Any

import dspy
from dspy.utils.exceptions import AdapterParseError, LMError

from vaso.errors import SkillError
from vaso.lm import explain
from vaso.local.adapter import BareAdapter
from vaso.local.constrain import constrained, follows_grammar
from vaso.modules.asking import FENCE, code_of, model_of
from vaso.modules.planner import WritePlan
from vaso.modules.wording import rules_text
from vaso.skill import ParameterName, Skill

HEADING = "Plan template:"
NOTHING = "none"
SAVED: tuple[ParameterName, ...] = ("local_rule", "labelling_code")
"""The texts that the instructions do not hold."""
GUIDANCE = f"""{WritePlan.instructions.strip()}

If there is a previous plan, the feedback says what a model checker found wrong with it: write a
plan without that fault. Keep what the task is for: a plan that only stops is no solution."""

WriteSkillPlan = (
    WritePlan.delete("plan_template")
    .insert(3, "previous_plan", dspy.InputField(desc="the plan that was tried before this"), str)
    .insert(4, "feedback", dspy.InputField(desc="what is wrong with the previous plan"), str)
)


class PlanWriter(dspy.Predict):  # type: ignore[misc]
    """Writes the plans of one skill.

    Attributes:
        base: The skill, whose template is the one that the instructions hold.
    """

    def __init__(self, skill: Skill) -> None:
        """Configure.

        Args:
            skill: The skill.
        """
        instructions = with_template(GUIDANCE, skill.plan_template)
        super().__init__(WriteSkillPlan.with_instructions(instructions))
        self.base = skill

    # -- the skill's texts ---------------------------------------------------------------------

    @property
    def signature(self) -> Any:
        """Task, rules, interfaces, previous plan and feedback in; plan out.

        The instructions hold the plan template in a fenced block. Where an optimizer writes bare
        code as instructions, it is taken as the template alone.
        """
        return self._signature

    @signature.setter
    def signature(self, signature: Any) -> None:
        written = signature.__doc__ or ""  # its property ``instructions`` removes indentation
        if _block(written) is None and _is_program(written):
            signature = signature.with_instructions(with_template(GUIDANCE, written))
        self._signature = signature

    @property
    def skill(self) -> Skill:
        """The skill, with the template that the instructions hold."""
        template = template_of(self.signature.instructions)
        if template == self.base.plan_template.expandtabs().strip("\n"):
            return self.base
        return self.base.with_parameters({"plan_template": template})

    @skill.setter
    def skill(self, skill: Skill) -> None:
        instructions = with_template(self.signature.instructions, skill.plan_template)
        self.signature = self.signature.with_instructions(instructions)
        self.base = skill

    def dump_state(self, json_mode: bool = True) -> dict[str, Any]:
        """The state of a ``dspy.Predict``, with the texts that the instructions do not hold."""
        texts = self.base.parameters
        state: dict[str, Any] = super().dump_state(json_mode=json_mode)
        kept: dict[str, str] = {name: texts[name] for name in SAVED}
        return state | {"skill": {"name": self.base.name} | kept}

    def load_state(self, state: dict[str, Any], **options: Any) -> PlanWriter:
        """Take up a saved state. The global rules stay those of this program's skill.

        Raises:
            SkillError: The state is of another skill, or its local rule cannot be read.
        """
        kept = state.get("skill") or {}
        if kept.get("name", self.base.name) != self.base.name:
            raise SkillError(
                f"the saved state is of the skill '{kept['name']}'",
                expected=f"a state of '{self.base.name}'",
            )
        own = self.base.parameters
        texts: dict[ParameterName, str] = {
            name: kept[name]
            for name in SAVED
            if name in kept and kept[name].strip("\n") != own[name].strip("\n")
        }
        base = self.base.with_parameters(texts)
        super().load_state({k: v for k, v in state.items() if k != "skill"}, **options)
        self.base = base
        return self

    # -- asking a model ------------------------------------------------------------------------

    def inputs(
        self, skill: Skill, task: str, previous: str = "", feedback: str = ""
    ) -> dict[str, str]:
        """The input fields for a task."""
        return {
            "task": task,
            "rules": rules_text(skill.rules, skill.platform),
            "apis": skill.labelling_code,
            "previous_plan": previous or NOTHING,
            "feedback": feedback or NOTHING,
        }

    def write(self, skill: Skill, inputs: dict[str, str], lm: Any = None) -> str:
        """Ask the model for a plan.

        Args:
            skill: Whose template to follow; by default its own.
            inputs: The input fields.
            lm: The model; by default the predictor's, or the configured one.

        Raises:
            ModelError: No model is configured, it cannot be reached, or it answers with an error.
        """
        context, options = self._asking(skill, lm)
        try:
            with context:
                reply = self(**inputs, **options)
            return code_of(str(reply.plan or ""))
        except AdapterParseError as error:
            return self.record(code_of(str(error.lm_response or "")), inputs)
        except LMError as error:
            raise explain(error) from error

    async def awrite(self, skill: Skill, inputs: dict[str, str], lm: Any = None) -> str:
        """:meth:`write`, without blocking the event loop."""
        context, options = self._asking(skill, lm)
        try:
            with context:
                reply = await self.acall(**inputs, **options)
            return code_of(str(reply.plan or ""))
        except AdapterParseError as error:
            return self.record(code_of(str(error.lm_response or "")), inputs)
        except LMError as error:
            raise explain(error) from error

    def record(self, plan: str, inputs: dict[str, str]) -> str:
        """Note a plan that did not come out of a call in dspy's trace, for optimizers to see."""
        self._forward_postprocess([{"plan": plan}], self.signature, **inputs)
        return plan

    def _asking(self, skill: Skill, lm: Any) -> tuple[AbstractContextManager[Any], dict[str, Any]]:
        """The settings and the options of a call.

        A model that can follow a grammar is tied to that of the skill's plans. A reply without the
        format may be the bare code, so that it is not asked for a second time in JSON.
        """
        lm = constrained(lm or model_of(self), skill, "plan_template")
        bare = BareAdapter() if follows_grammar(lm) else None
        adapter = bare or dspy.settings.adapter or dspy.ChatAdapter(use_json_adapter_fallback=False)
        options: dict[str, Any] = {} if self.lm is None else {"lm": lm}
        if skill.plan_template != self.skill.plan_template:
            instructions = with_template(self.signature.instructions, skill.plan_template)
            options["signature"] = self.signature.with_instructions(instructions)
        return dspy.context(lm=lm, adapter=adapter), options


def with_template(instructions: str, template: str) -> str:
    """Put a plan template into instructions, in place of the one that they hold.

    Args:
        instructions: Any text.
        template: Python source.
    """
    fence = "`" * max([3, *(len(run) + 1 for run in re.findall("`{3,}", template))])
    block = f"{fence}python\n{template.strip(chr(10))}\n{fence}"
    if found := _block(instructions):
        return instructions[: found.start()] + block + instructions[found.end() :]
    return f"{instructions.rstrip()}\n\n{HEADING}\n\n{block}"


def template_of(instructions: str) -> str:
    """The plan template in instructions: their longest Python block.

    Returns:
        The template, or an empty string where the instructions hold none.
    """
    found = _block(instructions)
    return str(found.group(3)).strip("\n") if found else ""


def _block(instructions: str) -> re.Match[str] | None:
    blocks = [m for m in FENCE.finditer(instructions) if m.group(2).lower() in PYTHON]
    return max(blocks, key=lambda m: len(m.group(3)), default=None)


PYTHON = ("", "python", "py", "python3")


def _is_program(text: str) -> bool:
    """True for Python that calls something; a sentence never is."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return False
    return any(isinstance(node, ast.Call) for node in ast.walk(tree))
