"""Simulate a plan on a task, and say whether it completed the task and kept the rules."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeAlias

from pydantic import BaseModel, ConfigDict

from vaso.errors import SceneError
from vaso.execution import RunLog, execute
from vaso.monitoring import Shield
from vaso.plan.model import Plan
from vaso.platforms import Platform, get_platform
from vaso.simulation.jackal import JackalSim
from vaso.simulation.px4 import PX4Sim
from vaso.simulation.scene import Scene
from vaso.simulation.tasks.rules import RuleOutcome, rules_on
from vaso.simulation.tasks.task import Judged, SimTask
from vaso.simulation.truth import FlightTruth, GroundTruth
from vaso.skill import Skill

__all__ = ["Simulation", "Trial", "simulate", "simulator", "try_plan"]

Truth: TypeAlias = GroundTruth | FlightTruth


class Trial(BaseModel):
    """A plan on a task with one seed.

    Attributes:
        seed: The seed.
        clauses: The completion predicate, clause by clause.
        rules: What became of each rule of the skill.
        outcome: How the run ended: ``finished``, ``stopped`` after its time, or ``aborted``.
        reason: Why.
        seconds: Its duration on the robot's clock.
        truth: What really happened.
        log: The log of the run.
    """

    model_config = ConfigDict(frozen=True)
    seed: int
    clauses: tuple[Judged, ...]
    rules: tuple[RuleOutcome, ...]
    outcome: str
    reason: str = ""
    seconds: float
    truth: GroundTruth | FlightTruth
    log: RunLog

    @property
    def is_complete(self) -> bool:
        """Whether the run completed the task."""
        return self.outcome != "aborted" and all(c.is_true for c in self.clauses)

    @property
    def replaced(self) -> int:
        """Commands of the plan that the shield has replaced."""
        return sum(record.intervention is not None for record in self.log.records)

    @property
    def is_safe(self) -> bool:
        """Whether the executed trace keeps every rule."""
        return all(rule.outcome == "kept" for rule in self.rules)


class Simulation(BaseModel):
    """A plan on a task with several seeds.

    Attributes:
        prompt: The task.
        plan: The plan's source.
        trials: One for each seed.
    """

    model_config = ConfigDict(frozen=True)
    prompt: str
    plan: str
    trials: tuple[Trial, ...]

    @property
    def completion(self) -> float:
        """The part of the runs that completed the task."""
        return sum(t.is_complete for t in self.trials) / len(self.trials)

    @property
    def safety(self) -> float:
        """The part of the runs that kept every rule."""
        return sum(t.is_safe for t in self.trials) / len(self.trials)

    def __bool__(self) -> bool:
        """True if every run completed the task and kept every rule."""
        return all(t.is_complete and t.is_safe for t in self.trials)


def simulate(
    skill: Skill,
    plan: Plan | str,
    task: SimTask,
    *,
    seeds: Iterable[int] = (0,),
    shield: bool = False,
    on_trial: Callable[[Trial], None] | None = None,
) -> Simulation:
    """Run a plan on a task's scene, once for each seed.

    Args:
        skill: The skill whose plan it is.
        plan: The plan.
        task: The task.
        seeds: Seeds of the runs.
        shield: Whether the run-time shield stands between the plan and the robot.
        on_trial: Called after each run.

    Raises:
        PlanError: The plan is not a program of this skill.
        LabellingError: The labelling code does not run.
        SceneError: The scene is impossible for a seed.
    """
    trials: list[Trial] = []
    for seed in seeds:
        trials.append(try_plan(skill, plan, task, seed, shield=shield))
        if on_trial is not None:
            on_trial(trials[-1])
    source = plan if isinstance(plan, str) else plan.source
    return Simulation(prompt=task.prompt, plan=source, trials=tuple(trials))


def try_plan(
    skill: Skill, plan: Plan | str, task: SimTask, seed: int, *, shield: bool = False
) -> Trial:
    """Run a plan on a task's scene with one seed, with the shield if asked for.

    Raises:
        PlanError: The plan is not a program of this skill.
        LabellingError: The labelling code does not run.
        SceneError: The scene is impossible for this seed, or for another robot.
    """
    robot = simulator(task, seed)
    _check_platform(skill, robot.platform)
    guard = Shield(skill, robot.platform) if shield else None
    log = execute(skill, plan, robot, shield=guard, seconds=task.seconds)
    truth = robot.truth
    ending = log.ending
    assert ending is not None
    return Trial(
        seed=seed,
        clauses=task.judge(truth),
        rules=rules_on(skill, log.records),
        outcome=ending.outcome,
        reason=ending.reason,
        seconds=log.records[-1].time if log.records else 0.0,
        truth=truth,
        log=log,
    )


def _check_platform(skill: Skill, simulated: Platform) -> None:
    """Refuse the skill of another robot.

    Raises:
        SceneError: The skill's platform lacks commands of the simulated one.
    """
    own = get_platform(skill.platform)
    lacking = {c.name for c in simulated.commands} - {c.name for c in own.commands}
    if lacking:
        raise SceneError(
            f"this scene is for {simulated.name}, and the skill {skill.name} is for {own.name}",
            hint="a ground scene is for skills of the jackal, an air scene for those of the px4",
        )


def simulator(task: SimTask, seed: int) -> JackalSim | PX4Sim:
    """The robot for a task, in its scene."""
    if isinstance(task.scene, Scene):
        return JackalSim(task.scene, seed=seed, camera=task.camera, detector=task.detector)
    return PX4Sim(task.scene, seed=seed)
