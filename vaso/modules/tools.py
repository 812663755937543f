"""The verifier and skills as tools for agents, such as ``dspy.ReAct``."""

from __future__ import annotations

import asyncio
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

import dspy

from vaso.errors import VasoError
from vaso.gradient.model import Level
from vaso.modules.asking import code_of
from vaso.modules.attempts import PlannerLike, level_of
from vaso.modules.skill_program import SkillProgram
from vaso.modules.verdicts import verdicts
from vaso.plan.model import Plan
from vaso.skill import Skill
from vaso.skill_file import load_skill
from vaso.verdict import Verdict, VerificationResult
from vaso.verifiers import Verifier

Execute = Callable[[Plan], Any]


class _Tool(dspy.Tool):  # type: ignore[misc]
    """A tool whose work does not block the event loop: ``acall`` does it in a thread."""

    async def acall(self, **kwargs: Any) -> Any:
        """Call the tool from a coroutine."""
        return await asyncio.to_thread(self, **kwargs)


def verify_tool(
    skill: Skill | str | Path,
    *,
    level: Level | str = Level.BLAME,
    verifier: str | Verifier | None = None,
    name: str = "",
) -> dspy.Tool:
    """The verifier as a tool: the text of a plan in; the verdict and a counterexample out.

    Args:
        skill: The skill whose rules count.
        level: How much the tool says about a violation.
        verifier: A verifier or its name.
        name: The tool's name; by default ``verify_`` and the skill's name.

    Returns:
        The tool. What is wrong with a plan it says, and never raises.

    Raises:
        SkillError: There is no such skill.
    """
    chosen = skill if isinstance(skill, Skill) else load_skill(skill)
    level = level_of(level)

    def verify_plan(plan: str | None = None) -> str:
        source = code_of(plan or "")
        return _said(lambda: _verdict(chosen, Plan(source=source), level, verifier))

    return _Tool(
        verify_plan,
        name=name or f"verify_{tool_name(chosen)}",
        desc=f"Checks a Python plan of the skill '{chosen.name}' before it runs: does every "
        "behaviour keep every rule? Answers with the verdict and counterexamples. "
        f"The rules: {'; '.join(str(r) for r in chosen.rules)}",
        arg_desc={"plan": "the plan as Python source code"},
    )


def skill_tool(
    skill: Skill | str | Path | SkillProgram,
    *,
    execute: Execute | None = None,
    planner: PlannerLike | None = None,
    attempts: int = 3,
    level: Level | str = Level.BLAME,
    verifier: str | Verifier | None = None,
    name: str = "",
) -> dspy.Tool:
    """A skill as a tool that refuses to run what is not verified.

    The tool takes a task, for which it writes a plan, or a plan. Either is verified. Only a plan
    that is verified is executed; for any other the tool answers why not, with the counterexample.

    Args:
        skill: A skill, the name of a shipped one, a file, or a program of yours.
        execute: What to do with a verified plan: a function or a coroutine function. What it
            returns is part of the answer. By default nothing is done, and the answer is the plan.
        planner: As for :class:`~vaso.modules.SkillProgram`: None asks the language model.
        attempts: How many plans are tried at most.
        level: How much the tool says about a violation.
        verifier: A verifier or its name.
        name: The tool's name; by default the skill's name.

    Returns:
        The tool. What goes wrong, with a model or in the execution, it says and does not raise.

    Raises:
        SkillError: There is no such skill.
    """
    if isinstance(skill, SkillProgram):
        program = skill
    else:
        program = SkillProgram(skill, planner, attempts=attempts, level=level, verifier=verifier)
    chosen = program.skill

    def run_skill(task: str | None = None, plan: str | None = None) -> str:
        return _said(lambda: _run(program, task or "", plan or "", execute))

    return _Tool(
        run_skill,
        name=name or tool_name(chosen),
        desc=f"{chosen.description} Give a task, or a plan in Python. The plan is verified first, "
        "and refused with a counterexample if some behaviour violates a rule.",
        arg_desc={
            "task": "what the robot shall do, in words; a plan is written for it",
            "plan": "a plan as Python source code, instead of a task",
        },
    )


def tool_name(skill: Skill) -> str:
    """A skill's name as a function is named."""
    return skill.name.replace("-", "_")


def _run(program: SkillProgram, task: str, plan: str, execute: Execute | None) -> str:
    if plan.strip():
        chosen = Plan(source=code_of(plan), task=task or None)
        result = verdicts.result(program.skill, chosen, program.verifier)
        feedback = verdicts.feedback(program.skill, chosen, program.level, program.verifier)
    elif task.strip():
        found = program(task=task)
        chosen, result, feedback = found.plan, found.result, found.feedback
    else:
        return "REFUSED: there is nothing to do. Give a task or a plan."
    if not result:
        return f"REFUSED, nothing was executed: {_why(result)}\n\n{feedback}\n\n{_listing(chosen)}"
    return _executed(chosen, result, execute)


def _executed(plan: Plan, result: VerificationResult, execute: Execute | None) -> str:
    head = f"VERIFIED: all {len(result.specs)} rules hold on every behaviour of the plan."
    if execute is None:
        return f"{head} It was not executed.\n\n{_listing(plan)}"
    try:
        outcome = execute(plan)
        if inspect.iscoroutine(outcome):
            outcome = asyncio.run(outcome)
    except Exception as error:
        return f"{head} Its execution failed: {type(error).__name__}: {error}"
    return f"{head} It was executed." + (f"\n\n{outcome}" if outcome is not None else "")


def _verdict(skill: Skill, plan: Plan, level: Level, verifier: str | Verifier | None) -> str:
    result = verdicts.result(skill, plan, verifier)
    if result:
        return f"VERIFIED: all {len(result.specs)} rules hold on every behaviour of the plan."
    feedback = verdicts.feedback(skill, plan, level, verifier)
    return f"NOT VERIFIED: {_why(result)}\n\n{feedback}"


def _why(result: VerificationResult) -> str:
    count = f"{len(result.failures)} of {len(result.specs)} rules"
    if result.verdict is Verdict.FAIL:
        return f"{count} do not hold on every behaviour of the plan."
    return f"{count} cannot be decided."


def _listing(plan: Plan) -> str:
    return f"The plan:\n{plan.source}"


def _said(work: Callable[[], str]) -> str:
    """What there is to say, also where a skill or a model cannot be used. Agents need an answer."""
    try:
        return work()
    except VasoError as error:
        return f"It cannot be verified: {error}"
    except Exception as error:
        return f"It cannot be verified: {type(error).__name__}: {error}"
