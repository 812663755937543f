"""Several skills in one plan: an open instruction is split over skills, planned, and verified."""

from __future__ import annotations

import asyncio
from collections.abc import Generator, Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, Literal, TypeAlias

import dspy
from dspy.utils.exceptions import AdapterParseError, LMError
from pydantic import BaseModel

from vaso.errors import SkillError
from vaso.gradient.model import Level
from vaso.lm import explain
from vaso.modules.asking import model_of
from vaso.modules.attempts import PlannerLike, count_of, level_of
from vaso.modules.composition import Composition, Part, compose
from vaso.modules.skill_program import SkillProgram
from vaso.modules.symbolic import SymbolicPlanner
from vaso.modules.word_routing import route_by_words
from vaso.platforms import get_platform
from vaso.skill import Skill, shipped_skills
from vaso.verdict import Verdict
from vaso.verifiers import Verifier

Routing = Literal["model", "words"]
NOTHING = "none"
ENDING = "Other parts follow this one: the plan must come to an end, with the robot standing still."

Call: TypeAlias = tuple[dspy.Module, dict[str, Any]]
"""A module to call, and its arguments."""


class RoutedStep(BaseModel):
    """One step of an instruction.

    Attributes:
        skill: The name of a skill.
        task: What that skill is to do, in words.
    """

    skill: str
    task: str


class RouteInstruction(dspy.Signature):  # type: ignore[misc]
    """Split an instruction for a robot into steps that are carried out one after the other.

    Each step uses one of the skills, by its exact name, and has a task of its own in words: with
    the quantities, objects and directions that the instruction gives, and without references to
    other steps. Use as few steps as possible, and only skills for the same robot.
    """

    instruction: str = dspy.InputField(desc="what the robot shall do")
    skills: str = dspy.InputField(desc="the skills: name, robot, and what each is for")
    feedback: str = dspy.InputField(desc="what was wrong with the steps that were tried before")
    steps: list[RoutedStep] = dspy.OutputField(desc="the steps in order")


class SkillRouter(dspy.Module):  # type: ignore[misc]
    """Carries out an open instruction with several skills, as one verified plan.

    It chooses steps, each a skill with a task, plans each with its skill, joins the plans into one,
    and verifies that plan against the global rules of all the skills in it. Local rules speak of
    what a skill is for: each part is verified against its own, on its own.

    Calling it with an ``instruction`` gives a ``dspy.Prediction`` with the fields

    * ``plan`` and ``source`` (the whole plan; None where the parts cannot be joined);
    * ``steps``: the skills and tasks, and ``parts`` (:class:`~vaso.modules.composition.Part`): the
      plan, verification and place of each;
    * ``verified``: True only if the whole keeps all global rules, and each part keeps its own rules
      and is reached: one that follows a part which never ends is not;
    * ``verdict``, ``result``, ``counterexample`` (of the whole) and ``feedback``;
    * ``skill``: the contract of the whole; ``composition``, which says where a line belongs.

    Attributes:
        programs: A :class:`~vaso.modules.SkillProgram` for each skill, by name.
        route: The predictor that chooses steps.
        routing: ``model`` or ``words``.
        attempts: How many times steps are chosen, and the whole is planned, at most.
    """

    def __init__(
        self,
        skills: Iterable[Skill | str | Path | SkillProgram] | None = None,
        planner: PlannerLike | None = None,
        *,
        routing: Routing | None = None,
        attempts: int = 3,
        verifier: str | Verifier | None = None,
        level: Level | str = Level.BLAME,
        callbacks: list[Any] | None = None,
    ) -> None:
        """Configure.

        Args:
            skills: The skills to choose from; by default those that VASO ships.
            planner: As for :class:`~vaso.modules.SkillProgram`.
            routing: ``model`` asks the language model for the steps; ``words`` splits the
                instruction at "then" and goes by the words of the descriptions. By default
                ``words`` with a symbolic planner, which shall need no model, else ``model``.
            attempts: How many times steps are chosen, and the whole is planned, at most.
            verifier: A verifier or its name.
            level: How much the feedback says.
            callbacks: dspy callbacks of this module.

        Raises:
            SkillError: There is no such skill, two have one name, or an option is not one.
        """
        super().__init__(callbacks=callbacks)
        symbolic = isinstance(planner, SymbolicPlanner)
        if routing not in (None, "model", "words"):
            raise SkillError(f"there is no routing '{routing}'", expected="'model' or 'words'")
        self.programs: dict[str, SkillProgram] = {}
        options: dict[str, Any] = {"attempts": attempts, "verifier": verifier, "level": level}
        for skill in shipped_skills() if skills is None else skills:
            if isinstance(skill, SkillProgram):
                program = skill
            else:
                program = SkillProgram(skill, planner, **options)
            if program.skill.name in self.programs:
                raise SkillError(f"there are two skills with the name '{program.skill.name}'")
            self.programs[program.skill.name] = program
        if not self.programs:
            raise SkillError("there are no skills to choose from")
        self.route = dspy.Predict(RouteInstruction)
        self.routing = routing or ("words" if symbolic else "model")
        self.attempts, self.level, self.verifier = count_of(attempts), level_of(level), verifier

    # -- calling -------------------------------------------------------------------------------

    def forward(
        self, instruction: str, steps: Sequence[tuple[str, str]] | None = None
    ) -> dspy.Prediction:
        """Plan an instruction.

        Args:
            instruction: What the robot shall do.
            steps: The skills and tasks, where they are not to be chosen.

        Raises:
            SkillError: A step names no skill, or skills of two robots; or no steps can be chosen.
            ModelError: No model is configured, or it cannot be reached.
        """
        work = self._work(instruction, steps)
        reply: Any = None
        while True:
            try:
                module, inputs = work.send(reply)
            except StopIteration as done:
                return done.value
            try:
                with self._asking(module):
                    reply = module(**inputs)
            except AdapterParseError as error:
                reply = self._unreadable(module, error)
            except LMError as error:
                raise explain(error) from error

    async def aforward(
        self, instruction: str, steps: Sequence[tuple[str, str]] | None = None
    ) -> dspy.Prediction:
        """Plan an instruction without blocking the event loop."""
        work = self._work(instruction, steps)
        reply: Any = None
        while True:
            done, call = await asyncio.to_thread(_advance, work, reply)
            if call is None:
                return done
            module, inputs = call
            try:
                with self._asking(module):
                    reply = await module.acall(**inputs)
            except AdapterParseError as error:
                reply = self._unreadable(module, error)
            except LMError as error:
                raise explain(error) from error

    def _unreadable(self, module: dspy.Module, error: AdapterParseError) -> AdapterParseError:
        """Take an answer without the format for what it is, if it is about steps."""
        if module is not self.route:
            raise error
        return error

    def _asking(self, module: dspy.Module) -> AbstractContextManager[Any]:
        """The model for the router's own predictor; programs see to theirs."""
        if module is not self.route:
            return nullcontext()
        context: AbstractContextManager[Any] = dspy.context(lm=model_of(self.route))
        return context

    # -- the work ------------------------------------------------------------------------------

    def _work(
        self, instruction: str, steps: Sequence[tuple[str, str]] | None
    ) -> Generator[Call, Any, dspy.Prediction]:
        """Everything but the calls of modules, which it yields, and whose answers it is sent."""
        if not isinstance(instruction, str):
            raise SkillError(f"{instruction!r} is no instruction", expected="a text")
        if steps is not None:
            chosen = [_step(step) for step in steps]
            if problem := self._problem(chosen):
                raise SkillError(problem, expected=f"one of {', '.join(self.programs)}")
        elif self.routing == "words":
            chosen = route_by_words(instruction, [p.skill for p in self.programs.values()])
        else:
            chosen = yield from self._choose(instruction)
        parts = []
        for number, (name, task) in enumerate(chosen, start=1):
            hint = ENDING if number < len(chosen) else ""
            parts.append((yield from self._part(name, task, hint)))
        found = self._composed(parts, instruction)
        for _ in range(self.attempts - 1):
            if found.blamed is None or self._fixed(parts[found.blamed]):
                break
            name, task = chosen[found.blamed]
            parts[found.blamed] = yield from self._part(name, task, found.feedback)
            found = self._composed(parts, instruction)
        return _prediction(found, chosen)

    def _choose(self, instruction: str) -> Generator[Call, Any, list[tuple[str, str]]]:
        """Ask the model for steps until they can be used."""
        problem = ""
        for _ in range(self.attempts):
            inputs = {"instruction": instruction, "skills": self._described()}
            reply = yield self.route, {**inputs, "feedback": problem or NOTHING}
            if isinstance(reply, AdapterParseError):
                problem = "the answer did not keep to the format"
                continue
            steps = [(step.skill.strip(), step.task.strip()) for step in reply.steps]
            if not (problem := self._problem(steps)):
                return steps
        raise SkillError(
            f"the language model gave no steps that can be used: {problem}",
            hint="try a stronger model, or give steps=[(skill, task), …]",
        )

    def _described(self) -> str:
        return "\n".join(
            f"{name} ({p.skill.platform}): {p.skill.description}"
            for name, p in self.programs.items()
        )

    def _problem(self, steps: Sequence[tuple[str, str]]) -> str:
        """Why steps cannot be used; empty if they can."""
        if not steps:
            return "there are no steps"
        if unknown := [name for name, _ in steps if name not in self.programs]:
            return f"there is no skill '{unknown[0]}'"
        robots = {get_platform(self.programs[name].skill.platform).name for name, _ in steps}
        return "" if len(robots) == 1 else f"the skills are for {' and '.join(sorted(robots))}"

    def _part(self, name: str, task: str, feedback: str) -> Generator[Call, Any, Part]:
        program = self.programs[name]
        found = yield program, {"task": task, "feedback": feedback}
        return Part(program.skill, task, found.plan, found.result, found.feedback)

    def _composed(self, parts: Sequence[Part], instruction: str) -> Composition:
        return compose(parts, instruction, verifier=self.verifier, level=self.level)

    def _fixed(self, part: Part) -> bool:
        """True where planning again would give the same plan."""
        return isinstance(self.programs[part.skill.name].planner, SymbolicPlanner)


def _step(step: Any) -> tuple[str, str]:
    pair = isinstance(step, (tuple, list)) and len(step) == 2
    if not pair or not all(isinstance(part, str) for part in step):
        raise SkillError(f"{step!r} is no step", expected="a pair of a skill's name and a task")
    skill, task = step
    return skill, task


def _advance(work: Generator[Call, Any, Any], reply: Any) -> tuple[Any, Call | None]:
    """A step of the work: its outcome, or the next call. An exception must not be StopIteration."""
    try:
        return None, work.send(reply)
    except StopIteration as done:
        return done.value, None


def _prediction(found: Composition, steps: list[tuple[str, str]]) -> dspy.Prediction:
    result = found.result
    failures = result.failures if result is not None else ()
    examples = [s.counterexample for s in failures if s.counterexample is not None]
    return dspy.Prediction(
        plan=found.plan,
        source=found.plan.source if found.plan else "",
        steps=steps,
        parts=found.parts,
        verified=bool(found),
        verdict=result.verdict if result is not None else Verdict.UNSUPPORTED,
        result=result,
        counterexample=next(iter(examples), None),
        feedback=found.feedback,
        skill=found.skill,
        composition=found,
    )
