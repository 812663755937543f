"""F_plan of the paper: a language model writes a plan from a skill's semantic contract."""

from __future__ import annotations

import ast
from typing import Any

import dspy

from vaso.local.constrain import constrained
from vaso.modules.asking import ask, code_of, model_of
from vaso.modules.wording import rules_text
from vaso.plan.model import Plan
from vaso.skill import Skill


class WritePlan(dspy.Signature):  # type: ignore[misc]
    """Write a Python program that carries out a task with a robot.

    Follow the plan template closely: keep its structure and its checks, and change the quantities
    that the task names. Call only functions that the proposition-aligned APIs define, plus `math`
    and `time`; do not define them again and import nothing else. What a program reads from a
    sensor decides the very next command only, so read again before every command. The program
    must satisfy every rule for every behaviour of the sensors. Answer with the program alone.
    """

    task: str = dspy.InputField(desc="what the robot shall do")
    rules: str = dspy.InputField(desc="temporal-logic rules, each with its reading in English")
    apis: str = dspy.InputField(desc="Python: proposition-aligned APIs that the plan may call")
    plan_template: str = dspy.InputField(desc="Python: a program that keeps the rules")
    plan: str = dspy.OutputField(desc="Python source code only")


class MendPlan(WritePlan):
    """Correct a Python program for a robot that is not valid Python.

    Keep what it does, call only functions that the proposition-aligned APIs define, and answer
    with the whole corrected program alone.
    """

    rejected: str = dspy.InputField(desc="the program that is not valid Python")
    error: str = dspy.InputField(desc="why it was rejected")


class Planner(dspy.Module):  # type: ignore[misc]
    """Writes a plan for a task, guided by the template of a skill.

    Calling it gives a ``dspy.Prediction`` with the field ``plan`` (:class:`~vaso.plan.Plan`), and
    that plan's ``source`` and ``task``, so that it passes for a plan where one is expected. A
    reply that is not Python is sent back with the error; one that still is not is returned as it
    is, and verifying it says what is wrong with it. A model that can follow a grammar writes
    nothing but plans of the skill that compile.
    """

    def __init__(self, *, retries: int = 1) -> None:
        """Configure.

        Args:
            retries: How many times a reply that is not Python is sent back.
        """
        super().__init__()
        self.retries = retries
        self.write = dspy.Predict(WritePlan)
        self.mend = dspy.Predict(MendPlan)

    def forward(self, skill: Skill, task: Any) -> dspy.Prediction:
        """Write a plan.

        Args:
            skill: The skill.
            task: A prompt, or an object with an attribute ``prompt``.

        Raises:
            ModelError: The language model cannot be reached.
        """
        prompt = str(getattr(task, "prompt", task))
        inputs = {
            "task": prompt,
            "rules": rules_text(skill.rules, skill.platform),
            "apis": skill.labelling_code,
            "plan_template": skill.plan_template,
        }
        lm = constrained(model_of(self.write), skill, "plan_template")
        source = code_of(ask(self.write, "plan", lm, **inputs))
        for _ in range(self.retries):
            if not (error := syntax_error(source)):
                break
            reply = ask(self.mend, "plan", lm, **inputs, rejected=source, error=error)
            source = code_of(reply) or source
        return dspy.Prediction(plan=Plan(source=source, task=prompt), source=source, task=prompt)


def syntax_error(source: str) -> str:
    """Why a text is not a Python program; empty if it is one."""
    if not source.strip():
        return "the program is empty"
    try:
        ast.parse(source)
    except SyntaxError as error:
        return f"line {error.lineno}: {error.msg}"
    except (ValueError, RecursionError, MemoryError) as error:
        return f"{type(error).__name__}: {error}"
    return ""
