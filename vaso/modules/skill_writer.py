"""F_skill of the paper: a language model writes and refines the contract of a skill."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import dspy

from vaso.errors import FormulaError, PlanError, PlatformError, SkillError
from vaso.modules.asking import ask, document_of
from vaso.modules.wording import platform_text, rules_text
from vaso.platforms import Platform
from vaso.skill import Rule, Skill
from vaso.skill_file import read_skills, write_skill

ATTEMPTS = 3


class WriteSkill(dspy.Signature):  # type: ignore[misc]
    """Write the contract of a robot skill for a task, as a Markdown file.

    You are given the low-level commands and sensors of a robot and the global rules (linear
    temporal logic) that every skill of this robot must keep. Derive a skill with a name, a Global
    Contract, a Local Contract and a Semantic Contract.

    Global Contract: the given global rules, word for word. You may not change, weaken or drop one.

    Local Contract: what this skill itself promises, as formulas of linear temporal logic over the
    same propositions (operators G F X U, ! & | ->, comparisons such as speed < 0.5). Every formula
    must be consistent with the global rules, also in the situations that it speaks about.

    Semantic Contract: Python that ties each proposition to the robot.
    - For every proposition of a formula, one function with exactly the proposition's name.
    - A proposition about an observation is a function that returns a bool.
    - A proposition about an action is a function that carries the action out.
    - A proposition about a number, such as a speed, is a function that returns its current value.
    - A proposition that depends on state which no sensor reports keeps that state in a global
      variable, initialized at the top and updated by every function that changes it.
    - Only these functions (and helpers that they share, such as set_velocity) call the low-level
      commands and sensors; the plan template calls none of them directly.
    - Assert the global limits at run time where a command could break them.

    Plan Template: a short Python program that carries the skill out safely by calling these
    functions. What it reads from a sensor decides the very next command only, so it reads again
    before every command.

    Format, with nothing before or after it:

    ## Skill: <name-in-lower-case-with-hyphens>
    <one sentence: what it does and when to use it>
    ### Global Contract
    <one formula a line, each in a list item>
    ### Local Contract
    <one formula a line, each in a list item>
    ### Semantic Contract
    #### Proposition-aligned APIs
    <a fenced python block>
    #### Plan Template
    <a fenced python block>
    """

    task: str = dspy.InputField(desc="what the skill is for, as a task prompt")
    platform: str = dspy.InputField(desc="the robot: commands, sensors, standard propositions")
    global_rules: str = dspy.InputField(desc="rules that the Global Contract repeats")
    feedback: str = dspy.InputField(desc="what was wrong with the draft before this one")
    skill_md: str = dspy.OutputField(desc="the Markdown file")


REFINING = """

You are also given the current file, and feedback on it from a model checker. Write the whole file
again so that plans which follow its template satisfy every rule. Change as little as needed: first
the plan template, then the functions, and the Local Contract only if the feedback says that it
cannot be kept."""

RefineSkill = WriteSkill.with_instructions(WriteSkill.instructions + REFINING).prepend(
    "skill_md_before", dspy.InputField(desc="the current file"), str
)


@dataclass(frozen=True, slots=True)
class Draft:
    """One reply of the model and what became of it.

    Attributes:
        text: The reply.
        skill: The skill read from it, with the global contract as given; None if unreadable.
        feasibility: Its feasibility check; None if unreadable.
        problem: What is wrong with it, as it is told to the model; empty if nothing is.
        reinstated: True when the reply had changed the global contract.
    """

    text: str
    skill: Skill | None = None
    feasibility: Any = None
    problem: str = ""
    reinstated: bool = False


class SkillWriter(dspy.Module):  # type: ignore[misc]
    """Writes and refines skills; every reply is read back and checked before it counts.

    Calls give a ``dspy.Prediction`` with the fields ``skill`` (the best draft), ``feasibility`` and
    ``drafts``. A draft that cannot be read, or whose rules cannot be kept together, is sent back
    with the reason. The global contract is taken from the caller, whatever the model writes.
    """

    def __init__(self, *, attempts: int = ATTEMPTS, timeout: float = 10.0) -> None:
        """Configure.

        Args:
            attempts: How many drafts are asked for at most.
            timeout: Seconds for the feasibility check of a draft.
        """
        super().__init__()
        self.attempts = attempts
        self.timeout = timeout
        self.write = dspy.Predict(WriteSkill)
        self.rewrite = dspy.Predict(RefineSkill)

    def forward(
        self,
        task: str,
        *,
        platform: str | Path | Platform,
        global_rules: Sequence[str | Rule] = (),
        feedback: str = "",
    ) -> dspy.Prediction:
        """Write a skill for a task.

        Args:
            task: The task prompt.
            platform: The robot.
            global_rules: The global contract.
            feedback: What the first draft should heed.

        Raises:
            SkillError: No draft could be read; the message says what was wrong with the last one.
            ModelError: The language model cannot be reached.
            FormulaError: A global rule does not parse.
        """
        rules = tuple(r if isinstance(r, Rule) else _rule(r) for r in global_rules)
        name = platform.name if isinstance(platform, Platform) else str(platform)
        inputs = {
            "task": task,
            "platform": platform_text(platform),
            "global_rules": rules_text(rules, platform),
        }

        def adopt(found: Skill) -> Skill:
            return found.model_copy(update={"global_rules": rules, "platform": name})

        drafts = self._drafts(partial(ask, self.write, "skill_md", **inputs), adopt, feedback)
        return self._prediction(drafts, None)

    def refine(self, skill: Skill, gradient: Any, task: str) -> dspy.Prediction:
        """Rewrite a skill so that it heeds a textual gradient.

        Args:
            skill: The skill to improve.
            gradient: A :class:`~vaso.gradient.TextualGradient`, or any text.
            task: The task prompt that it was verified on.

        Returns:
            As for a call; ``skill`` is the one given if no draft could be read.

        Raises:
            ModelError: The language model cannot be reached.
        """
        inputs = {
            "task": task,
            "platform": platform_text(skill.platform),
            "global_rules": rules_text(skill.global_rules, skill.platform),
            "skill_md_before": write_skill(skill),
        }
        adopt = partial(_merge, skill)
        drafts = self._drafts(
            partial(ask, self.rewrite, "skill_md", **inputs), adopt, str(gradient)
        )
        return self._prediction(drafts, skill)

    def _drafts(
        self, reply: Callable[..., str], adopt: Callable[[Skill], Skill], feedback: str
    ) -> list[Draft]:
        drafts: list[Draft] = []
        told = feedback
        for _ in range(max(1, self.attempts)):
            draft = self._read(document_of(reply(feedback=told or "none")), adopt)
            drafts.append(draft)
            if not draft.problem:
                break
            told = "\n\n".join(t for t in (feedback, draft.problem) if t)
        return drafts

    def _read(self, text: str, adopt: Callable[[Skill], Skill]) -> Draft:
        try:
            written = _first(text)
            skill = adopt(written)
            feasibility = self._feasibility(skill)
        except (SkillError, FormulaError, PlanError, PlatformError) as error:
            return Draft(text, problem=f"The draft cannot be used: {error}")
        reinstated = _formulas(written.global_rules) != _formulas(skill.global_rules)
        problem = feasibility.feedback if feasibility.hopeless else ""
        return Draft(text, skill, feasibility, problem, reinstated)

    def _feasibility(self, skill: Skill) -> Any:
        from vaso.feasibility import check

        return check(skill, timeout=self.timeout)

    def _prediction(self, drafts: list[Draft], before: Skill | None) -> dspy.Prediction:
        readable = [d for d in drafts if d.skill]
        good = [d for d in readable if not d.problem]
        best = next(iter(good or readable[-1:]), None)
        if best is None and before is None:
            raise SkillError(
                f"the language model wrote no readable skill in {len(drafts)} attempts; "
                f"the last one: {drafts[-1].problem}",
                hint="try a stronger model, or more attempts",
            )
        skill = best.skill if best else before
        feasibility = best.feasibility if best else None
        return dspy.Prediction(skill=skill, feasibility=feasibility, drafts=tuple(drafts))


def _rule(text: str) -> Rule:
    from vaso.ltl import parse

    parse(text)
    return Rule(text=text)


def _first(text: str) -> Skill:
    if not text.strip():
        raise SkillError("the reply is empty", expected="a skill file in Markdown")
    found = read_skills(text, source="the draft")
    if not found:
        raise SkillError("the reply holds no skill", expected="a heading '## Skill: <name>'")
    if not found[0].local_rules:
        raise SkillError("the Local Contract has no formula", expected="one or more LTL formulas")
    return found[0]


def _merge(skill: Skill, draft: Skill) -> Skill:
    changes: dict[str, Any] = {
        "local_rules": draft.local_rules,
        "labelling_code": draft.labelling_code,
        "plan_template": draft.plan_template,
    }
    if draft.description:
        changes["description"] = draft.description
    return skill.model_copy(update=changes)


def _formulas(rules: Sequence[Rule]) -> list[str]:
    return [str(r) for r in rules]
