"""VASO as a DSPy optimizer: ``VASO(optimizer="repair").compile(student, trainset=…)``."""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import dspy
from dspy.teleprompt.teleprompt import Teleprompter

from vaso.errors import OptimizerError
from vaso.gradient.model import Level
from vaso.modules.attempts import PlannerLike
from vaso.modules.metric import verifier_metric
from vaso.modules.skill_program import SkillProgram
from vaso.modules.symbolic import SymbolicPlanner
from vaso.optimizers.base import OnEvent, Optimizer, Proposer
from vaso.optimizers.budget import Budget, Spent
from vaso.optimizers.result import OptimizationResult
from vaso.optimizers.run import optimize
from vaso.optimizers.session import Driver
from vaso.optimizers.students import skill_programs, tasks_of
from vaso.skill import ParameterName, Skill

SAFETY = verifier_metric(feedback=False)


@dataclass(frozen=True)
class CompileReport:
    """What a compilation did. Truthy only if every skill is verified on every task.

    Attributes:
        results: The optimization of each skill, by the path of its program in the student.
        val_before: Score of the student on the validation set, in percent; None without one.
        val_after: Score of the compiled program on it.
    """

    results: dict[str, OptimizationResult]
    val_before: float | None = None
    val_after: float | None = None

    def __bool__(self) -> bool:
        """True only if every skill is verified on every task that it was given."""
        return bool(self.results) and all(self.results.values())

    def __str__(self) -> str:
        """The report in plain text."""
        lines = [f"{name}: {result.summary()}" for name, result in self.results.items()]
        if self.val_after is not None:
            lines.append(f"validation: {self.val_before:.1f} % -> {self.val_after:.1f} %")
        return "\n\n".join(lines)


class VASO(Teleprompter):  # type: ignore[misc]
    """Optimizes every skill in a DSPy program until its plans are verified.

    The student is a :class:`~vaso.modules.SkillProgram` or any ``dspy.Module`` that has some in it.
    ``compile`` returns a copy in which the texts of each skill (plan template, labelling code) are
    those that :func:`vaso.optimize` found; the student stays as it is. The copy's
    ``detailed_results`` is a :class:`CompileReport`.
    """

    def __init__(
        self,
        metric: Any = None,
        *,
        optimizer: str | Optimizer | Proposer | Driver = "repair",
        lm: Any = None,
        level: Level | str = Level.BLAME,
        trainable: Sequence[ParameterName] | None = None,
        budget: Budget | int | dict[str, Any] | None = None,
        seed: int = 0,
        out: str | Path | None = None,
        resume: bool = False,
        on_event: OnEvent | None = None,
        num_threads: int | None = None,
    ) -> None:
        """Configure.

        Args:
            metric: Scores the program on the validation set, for the report alone: the verifier
                decides what is accepted. By default the score is the safety of each skill's plans.
            optimizer: A name from :func:`vaso.optimizers.optimizers`, or an instance.
            lm: A ``dspy.LM`` or its name, for optimizers that need one; by default the configured
                one. Plans are drawn with the student's own model, where it has one.
            level: How much textual gradients say: ``verdict``, ``trace``, ``blame``, ``repair``.
            trainable: The texts that may change.
            budget: What may be spent on all skills together; a number is a number of steps.
            seed: Seed of everything random.
            out: A folder for checkpoints, logs and the best skills; one folder in it for each skill
                where the student has several.
            resume: Go on with the run in ``out``.
            on_event: Called with every event of the optimization.
            num_threads: Threads for scoring the validation set.

        Raises:
            OptimizerError: A budget that cannot be read.
        """
        super().__init__()
        self.metric = metric
        self.optimizer = optimizer
        self.lm = lm
        self.level = level
        self.trainable = trainable
        self.budget = Budget.of(budget)
        self.seed = seed
        self.out = out
        self.resume = resume
        self.on_event = on_event
        self.num_threads = num_threads

    def compile(
        self,
        student: dspy.Module,
        *,
        trainset: Sequence[Any],
        teacher: dspy.Module | None = None,
        valset: Sequence[Any] | None = None,
    ) -> dspy.Module:
        """Optimize the skills of a program.

        Args:
            student: The program. It is not changed.
            trainset: Examples whose field ``task``, or else first input field, is a task prompt. A
                student with several skills is run on them once, to see which tasks each one gets.
            teacher: Not used by this optimizer.
            valset: Examples to report on. They have no part in the optimization.

        Returns:
            The compiled copy.

        Raises:
            OptimizerError: There is no skill in the student, no task in the trainset, or a teacher.
            ModelError: A language model is needed and none is given.
        """
        if teacher is not None:
            raise OptimizerError("VASO does not use a teacher", hint="leave teacher= out")
        compiled = student.deepcopy()
        programs = skill_programs(compiled)
        if not programs:
            raise OptimizerError(
                f"there is no skill in {type(student).__name__}",
                expected="a vaso.modules.SkillProgram, or a module that has one as an attribute",
            )
        results: dict[str, OptimizationResult] = {}
        for name, tasks in tasks_of(compiled, programs, trainset).items():
            spent = [result.spent for result in results.values()]
            folder = _folder(self.out, name, alone=len(programs) == 1)
            results[name] = self._optimize(programs[name], tasks, _left(self.budget, spent), folder)
            programs[name].skill = results[name].skill
        if not results:
            raise OptimizerError("no skill of the student gets a task", expected="a trainset")
        scores = [self._score(p, valset) if valset else None for p in (student, compiled)]
        compiled.detailed_results = CompileReport(results, *scores)
        compiled._compiled = True
        return compiled

    def _optimize(
        self, program: SkillProgram, tasks: list[str], budget: Budget, out: Path | None
    ) -> OptimizationResult:
        own, program.write.lm = program.write.lm, None  # so that calls of it are metered as well
        try:
            return optimize(
                program.skill,
                tasks,
                optimizer=self.optimizer,
                lm=self.lm if self.lm is not None else own,
                planner=_planner(program),
                planner_lm=own,
                level=self.level,
                trainable=self.trainable,
                out=out,
                resume=self.resume,
                budget=budget,
                seed=self.seed,
                on_event=self.on_event,
            )
        finally:
            program.write.lm = own

    def _score(self, program: dspy.Module, valset: Sequence[Any]) -> float:
        """Score in percent: by the user's metric, or how safe the plans of each skill are."""
        with _no_log("dspy.evaluate.evaluate"):
            if self.metric is not None:
                return self._evaluate(program, list(valset), self.metric)
            programs = skill_programs(program)
            found = [
                (self._evaluate(programs[name], [_example(t) for t in tasks], SAFETY), len(tasks))
                for name, tasks in tasks_of(program, programs, valset).items()
            ]
        return sum(score * count for score, count in found) / max(1, sum(n for _, n in found))

    def _evaluate(self, program: dspy.Module, devset: list[Any], metric: Any) -> float:
        evaluate = dspy.Evaluate(devset=devset, metric=metric, num_threads=self.num_threads)
        return float(evaluate(program).score)


# -- drawing plans -----------------------------------------------------------------------------


class DrawPlans(dspy.Module):  # type: ignore[misc]
    """A planner that draws single plans with a program's own predictor or planner."""

    def __init__(self, program: SkillProgram) -> None:
        super().__init__()
        self.program = program

    def forward(self, skill: Skill, task: Any) -> dspy.Prediction:
        """Write a plan for a task with the texts of a skill."""
        return dspy.Prediction(plan=self.program.draw(skill, task))


def _planner(program: SkillProgram) -> PlannerLike:
    """What draws a plan for other texts than the program's own."""
    if isinstance(program.planner, SymbolicPlanner):
        return program.planner
    if program.planner is None or isinstance(program.planner, dspy.Module):
        return DrawPlans(program)
    return program.draw


def _example(task: str) -> Any:
    return dspy.Example(task=task).with_inputs("task")


# -- budget, folders, logs ---------------------------------------------------------------------


def _left(budget: Budget, spent: Sequence[Spent]) -> Budget:
    """What is left of a budget."""
    changes = {}
    for limit in fields(budget):
        value = getattr(budget, limit.name)
        if value is not None:
            changes[limit.name] = max(0, value - sum(getattr(s, limit.name) for s in spent))
    return replace(budget, **changes)


def _folder(out: str | Path | None, name: str, *, alone: bool) -> Path | None:
    if out is None:
        return None
    return Path(out) if alone else Path(out) / re.sub(r"\W+", "-", name).strip("-")


@contextmanager
def _no_log(name: str) -> Iterator[None]:
    """Keep what dspy notes about each evaluation from the user's terminal."""
    log = logging.getLogger(name)
    before = log.level
    log.setLevel(logging.WARNING)
    try:
        yield
    finally:
        log.setLevel(before)
