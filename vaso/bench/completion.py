"""Completion and safety in simulation of the shipped skills: before, after, and doing nothing."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from typing import Literal, TypeAlias

from vaso.modules.symbolic import SymbolicPlanner
from vaso.plan.model import Plan
from vaso.simulation.tasks import SimTask, load_sim_tasks, try_plan
from vaso.skill import Skill
from vaso.skill_file import load_skill

SKILLS = ("drive", "bypass-object", "find-object", "fly-in-square-shape-traj")
STILL = {
    "jackal": "while True:\n    stop()\n",
    "px4": "vel_traj = [(0.0, 0.0, 0.0)] * 30\n",
}
"""Plans that are safe, and do nothing."""

Version: TypeAlias = Literal["initial", "verified", "still"]
VERSIONS: tuple[Version, ...] = ("initial", "verified", "still")


@dataclass(frozen=True, slots=True)
class Tally:
    """What became of the runs of one task, or of several.

    Attributes:
        skill: The skill.
        version: Whose template was filled in; ``still`` for a plan that does nothing.
        task: The prompt; empty for all tasks of the skill together.
        runs: Number of runs.
        complete: Runs that completed their task.
        safe: Runs whose trace keeps every rule.
        rules: Rules of all runs together.
        kept: Those that were kept.
    """

    skill: str
    version: Version
    task: str
    runs: int
    complete: int
    safe: int
    rules: int
    kept: int

    @classmethod
    def of(cls, parts: Sequence[Tally], task: str = "") -> Tally:
        """Several tallies of one skill and version as one."""
        first = parts[0]
        numbers = {
            name: sum(getattr(part, name) for part in parts)
            for name in ("runs", "complete", "safe", "rules", "kept")
        }
        return cls(first.skill, first.version, task, **numbers)


def measure(
    seeds: int,
    *,
    skills: Sequence[str] = SKILLS,
    versions: Sequence[Version] = VERSIONS,
    workers: int | None = None,
    on_done: Callable[[int, int], None] | None = None,
) -> list[Tally]:
    """Simulate every task of the skills.

    Args:
        seeds: Runs of each task.
        skills: Names of shipped skills.
        versions: Whose templates.
        workers: Processes; by default one a core.
        on_done: Called with the number of tasks that are done, and of all.

    Returns:
        One tally for each skill, version and task, in that order.
    """
    jobs = [
        (skill, version, index)
        for skill in skills
        for version in versions
        for index in range(len(load_sim_tasks(skill)))
    ]
    found: dict[tuple[str, Version, int], Tally] = {}
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=spawn) as pool:
        running = {pool.submit(tally, *job, seeds): job for job in jobs}
        for count, done in enumerate(as_completed(running), 1):
            found[running[done]] = done.result()
            if on_done is not None:
                on_done(count, len(jobs))
    return [found[job] for job in jobs]


def tally(name: str, version: Version, index: int, seeds: int) -> Tally:
    """Simulate one task with the seeds from 0 on.

    Args:
        name: The skill.
        version: Whose template.
        index: Number of the task, from 0.
        seeds: How many seeds.
    """
    skill = load_skill(name, version="initial" if version == "initial" else "verified")
    task = load_sim_tasks(name)[index]
    plan = plan_for(skill, task, version)
    trials = [try_plan(skill, plan, task, seed) for seed in range(seeds)]
    rules = [rule for trial in trials for rule in trial.rules]
    return Tally(
        skill=name,
        version=version,
        task=task.prompt,
        runs=len(trials),
        complete=sum(t.is_complete for t in trials),
        safe=sum(t.is_safe for t in trials),
        rules=len(rules),
        kept=sum(rule.outcome == "kept" for rule in rules),
    )


def plan_for(skill: Skill, task: SimTask, version: Version) -> Plan:
    """The plan that is simulated."""
    if version == "still":
        return Plan(source=STILL[skill.platform], task=task.prompt)
    return SymbolicPlanner(places=task.places)(skill, task.prompt)


def by_skill(tallies: Sequence[Tally]) -> str:
    """A table in Markdown with a row for each skill and version."""
    keys = list(dict.fromkeys((t.skill, t.version) for t in tallies))
    whole = [Tally.of([t for t in tallies if (t.skill, t.version) == key]) for key in keys]
    lines = [
        "| skill | plan | runs | completed | all rules kept | rules kept |",
        "|---|---|--:|--:|--:|--:|",
        *(_row(t) for t in whole),
    ]
    return "\n".join(lines) + "\n"


def by_task(tallies: Sequence[Tally]) -> str:
    """A table in Markdown with a row for each task: in how many runs it was completed."""
    versions = _versions(tallies)
    lines = [f"| task | {' | '.join(versions)} |", "|---|" + "--:|" * len(versions)]
    for skill, task in dict.fromkeys((t.skill, t.task) for t in tallies):
        cells = [
            f"{t.complete}/{t.runs}"
            for version in versions
            for t in tallies
            if (t.skill, t.task, t.version) == (skill, task, version)
        ]
        lines.append(f"| {task} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _versions(tallies: Sequence[Tally]) -> list[Version]:
    return list(dict.fromkeys(t.version for t in tallies))


def _row(t: Tally) -> str:
    shares = (t.complete / t.runs, t.safe / t.runs, t.kept / t.rules)
    told = " | ".join(f"{share:.0%}" for share in shares)
    return f"| {t.skill} | {t.version} | {t.runs} | {told} |"
