"""A skill as a DSPy module: a task in; a verified plan out, or the best one and why it is not."""

from __future__ import annotations

import asyncio
import inspect
from collections.abc import Awaitable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import dspy

from vaso.errors import SkillError
from vaso.gradient.model import Level
from vaso.modules.asking import model_of
from vaso.modules.attempts import (
    Attempt,
    PlannerLike,
    Search,
    count_of,
    level_of,
    plan_of,
    tracing,
)
from vaso.modules.plan_writer import PlanWriter
from vaso.modules.verdicts import verdicts
from vaso.plan.model import Plan
from vaso.skill import ParameterName, Skill
from vaso.skill_file import load_skill
from vaso.verifiers import Verifier

Strategy = Literal["feedback", "best_of"]
STRATEGIES: tuple[Strategy, ...] = ("feedback", "best_of")


class SkillProgram(dspy.Module):  # type: ignore[misc]
    """Plans with a skill, and verifies every plan before it is returned.

    Calling it with a ``task`` gives a ``dspy.Prediction`` with the fields

    * ``plan`` (:class:`~vaso.plan.Plan`), ``source`` (its text), ``task`` and ``skill``;
    * ``verified``: True only if every rule passes on every behaviour of the plan;
    * ``verdict``, ``result`` (:class:`~vaso.verdict.VerificationResult`), ``counterexample`` (the
      first one, or None) and ``feedback`` (the textual gradient);
    * ``attempts``: every plan that was tried, with its result.

    Plans are tried until one is verified. If none is, the safest one is returned with
    ``verified=False`` and its counterexample.

    The skill's texts are the module's parameters. The plan template is part of the instructions of
    the predictor ``write``, where DSPy's optimizers find it; labelling code and local rule are
    saved and loaded with it. ``vaso.optimizers.VASO`` optimizes all of them.

    Attributes:
        write: The predictor that holds the texts, and writes plans where there is no planner.
        planner: What writes plans instead, or None.
        attempts: How many plans are tried at most.
        strategy: ``feedback`` or ``best_of``.
        verifier: As for :func:`vaso.verify`.
        level: How much the feedback says.
    """

    def __init__(
        self,
        skill: Skill | str | Path,
        planner: PlannerLike | None = None,
        *,
        attempts: int = 3,
        strategy: Strategy = "feedback",
        verifier: str | Verifier | None = None,
        level: Level | str = Level.BLAME,
        callbacks: list[Any] | None = None,
    ) -> None:
        """Configure.

        Args:
            skill: A skill, the name of a shipped one, or a file.
            planner: None asks the language model, with the module's own predictor. A
                :class:`~vaso.modules.SymbolicPlanner` needs no model. Any other function or module
                is called with the skill and the task.
            attempts: How many plans are tried at most, at least one.
            strategy: ``feedback`` tells the planner what was wrong with its last plan; ``best_of``
                draws plans independently of each other.
            verifier: A verifier or its name.
            level: How much the feedback says: ``verdict``, ``trace``, ``blame``, or ``repair``,
                which searches for a verified edit of a plan that fails.
            callbacks: dspy callbacks of this module.

        Raises:
            SkillError: There is no such skill, or an option is not one.
        """
        super().__init__(callbacks=callbacks)
        if strategy not in STRATEGIES:
            raise SkillError(f"there is no strategy '{strategy}'", expected=" or ".join(STRATEGIES))
        if planner is not None and not callable(planner):
            raise SkillError(
                f"{planner!r} is not a planner",
                expected="a SymbolicPlanner, a Planner, or a function of a skill and a task",
            )
        self.write = PlanWriter(skill if isinstance(skill, Skill) else load_skill(skill))
        self.planner = planner
        self.attempts = count_of(attempts)
        self.strategy = strategy
        self.verifier = verifier
        self.level = level_of(level)

    # -- the skill's texts -----------------------------------------------------------------------

    @property
    def skill(self) -> Skill:
        """The skill with its texts as they are now."""
        return self.write.skill

    @skill.setter
    def skill(self, skill: Skill) -> None:
        self.write.skill = skill

    @property
    def texts(self) -> dict[ParameterName, str]:
        """The texts that can be optimized: local rule, labelling code, plan template."""
        return self.skill.parameters

    # -- planning --------------------------------------------------------------------------------

    def forward(self, task: Any, feedback: str = "") -> dspy.Prediction:
        """Plan a task.

        Args:
            task: A prompt, or an object with an attribute ``prompt``.
            feedback: What the first plan should heed already.

        Raises:
            ModelError: No model is configured, or it cannot be reached.
            SkillError: The skill's rules or assumptions cannot be used.
        """
        search = Search(self, task, feedback)
        while not search.over:
            with tracing() as steps:
                plan = self._draw(search)
            search.add(self._judged(search, plan), steps)
        return search.prediction()

    async def aforward(self, task: Any, feedback: str = "") -> dspy.Prediction:
        """Plan a task without blocking the event loop; verification runs in a thread."""
        search = Search(self, task, feedback)
        while not search.over:
            with tracing() as steps:
                plan = await self._adraw(search)
            search.add(await asyncio.to_thread(self._judged, search, plan), steps)
        return search.prediction()

    def draw(self, skill: Skill, task: Any) -> Plan:
        """Write one plan with the texts of a skill, without verifying it.

        Args:
            skill: The skill, which may have other texts than the module.
            task: A prompt, or an object with an attribute ``prompt``.

        Raises:
            ModelError: No model is configured, or it cannot be reached.
        """
        return self._draw(Search(self, task, skill=skill))

    def _judged(self, search: Search, plan: Plan) -> Attempt:
        result = verdicts.result(search.skill, plan, self.verifier)
        feedback = verdicts.feedback(search.skill, plan, self.level, self.verifier)
        return Attempt(plan, replace(result, system=None), feedback)

    def _draw(self, search: Search) -> Plan:
        inputs = search.inputs()
        if self.planner is None:
            lm = search.model(model_of(self.write))
            return Plan(source=self.write.write(search.skill, inputs, lm), task=search.task)
        args, options = search.arguments()
        with self._model(search):
            plan = plan_of(self.planner(*args, **options), search.task)
        self.write.record(plan.source, inputs)
        return plan

    async def _adraw(self, search: Search) -> Plan:
        inputs = search.inputs()
        if self.planner is None:
            lm = search.model(model_of(self.write))
            return Plan(source=await self.write.awrite(search.skill, inputs, lm), task=search.task)
        args, options = search.arguments()
        with self._model(search):
            plan = plan_of(await _call(self.planner, *args, **options), search.task)
        self.write.record(plan.source, inputs)
        return plan

    def _model(self, search: Search) -> AbstractContextManager[Any]:
        """The model that a planner of the user's asks, with a rollout of its own where needed."""
        used = dspy.settings.lm
        lm = search.model(used)
        return nullcontext() if lm is used else dspy.context(lm=lm)


async def _call(planner: PlannerLike, *args: Any, **options: Any) -> Any:
    """Call a planner from a coroutine: a coroutine of its own, or else in a thread."""
    if isinstance(planner, dspy.Module) and hasattr(type(planner), "aforward"):
        return await planner.acall(*args, **options)
    if inspect.iscoroutinefunction(planner):
        return await planner(*args, **options)
    answer = await asyncio.to_thread(planner, *args, **options)
    return await answer if isinstance(answer, Awaitable) else answer
