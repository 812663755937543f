"""``vaso simulate``: does a plan complete its task, and keep the rules, in a simulated world?"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vaso.cli.common import (
    ExitCode,
    JsonOption,
    NameOption,
    SkillArgument,
    Version,
    VersionOption,
    console,
    emit,
    get_plan,
    get_skill,
    leave,
)
from vaso.errors import SceneError, VasoError

if TYPE_CHECKING:
    from vaso.plan.model import Plan
    from vaso.simulation.tasks import SimTask, Simulation, Trial
    from vaso.skill import Skill


def simulate(
    skill: SkillArgument,
    plan: Annotated[
        str | None,
        typer.Option(
            help="A Python file with the plan; - for stdin; by default the template, with the "
            "quantities of the task."
        ),
    ] = None,
    task: Annotated[
        str | None,
        typer.Option(help="A task of the skill: its number, or words of it; by default each one."),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="How many runs of a task.")] = 5,
    seed: Annotated[int, typer.Option(min=0, help="The first run's seed.")] = 0,
    version: VersionOption = Version.VERIFIED,
    name: NameOption = None,
    tasks: Annotated[
        Path | None, typer.Option(help="Tasks with scenes, instead of the skill's completion.yaml.")
    ] = None,
    lm: Annotated[str | None, typer.Option(help="A language model that writes the plans.")] = None,
    shield: Annotated[
        bool, typer.Option("--shield", help="With the run-time shield before the robot.")
    ] = False,
    picture: Annotated[
        Path | None, typer.Option(help="Draw a run: the first that goes wrong, or the first.")
    ] = None,
    animation: Annotated[
        Path | None, typer.Option(help="Animate that run, as a .gif or .html file.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Simulate a plan in the scene of its task, and judge what really happened.

    A run completes its task if everything is true that the task asks for (docs/completion.md), and
    is safe if its trace keeps every rule of the skill. A plan need not be verified to be simulated.

    Exit code 0: every run completes its task and keeps every rule, 1: some run does not,
    2: bad input.
    """
    chosen = get_skill(skill, version, name)
    wanted = _choose(_load(chosen, tasks), task)
    if picture or animation:
        from vaso.simulation.drawing import check_names

        check_names(picture, animation)
        if len(wanted) > 1:
            raise VasoError("a picture is of one task", hint="name it with --task")
    given = get_plan(plan) if plan else None
    runs = _run(chosen, wanted, given, lm, range(seed, seed + seeds), shield)
    if as_json:
        emit(_json(chosen, version, plan, lm, runs))
    else:
        from vaso.report.simulation import simulation_view, simulations_view

        console().print(simulation_view(runs[0]) if len(runs) == 1 else simulations_view(runs))
    if picture or animation:
        _draw(chosen, runs[0], picture, animation)
    leave(ExitCode.HOLDS if all(runs) else ExitCode.REFUTED)


def _load(skill: Skill, path: Path | None) -> Sequence[SimTask]:
    from vaso.simulation.tasks import load_sim_tasks

    return load_sim_tasks(path or skill)


def _choose(tasks: Sequence[SimTask], wanted: str | None) -> Sequence[SimTask]:
    """The tasks that a text names: a number from 1, or words that only one prompt has.

    Raises:
        SceneError: No task fits, or several do.
    """
    if wanted is None:
        return tasks
    words = " ".join(wanted.split()).casefold()
    if words.isdecimal() and 1 <= int(words) <= len(tasks):
        return [tasks[int(words) - 1]]
    exact = [t for t in tasks if t.prompt.casefold().rstrip(".") == words.rstrip(".")]
    found = exact or [t for t in tasks if words and words in t.prompt.casefold()]
    if len(found) == 1:
        return found
    listed = "\n".join(f"  {i}. {t.prompt}" for i, t in enumerate(tasks, 1))
    what = "several tasks have these words" if found else "there is no scene for this task"
    raise SceneError(
        f"{what}: {wanted}",
        expected=f"one of these, or its number\n{listed}",
        hint="for a task of your own, write its scene into a file and give it with --tasks",
    )


def _run(
    skill: Skill,
    tasks: Sequence[SimTask],
    plan: Plan | None,
    lm: str | None,
    seeds: Sequence[int],
    shield: bool,
) -> list[Simulation]:
    from vaso.cli.plan import make_filling
    from vaso.cli.progress import Progress
    from vaso.simulation.tasks import simulate as run

    done, total = 0, len(tasks) * len(seeds)
    with Progress("simulating") as progress:

        def count(_: Trial) -> None:
            nonlocal done
            done += 1
            progress.update(done=done, total=total)

        return [
            run(
                skill,
                plan or make_filling(skill, t.prompt, lm, t.places).plan,
                t,
                seeds=seeds,
                shield=shield,
                on_trial=count,
            )
            for t in tasks
        ]


def _draw(skill: Skill, runs: Simulation, picture: Path | None, animation: Path | None) -> None:
    """Draw the first run that goes wrong, or else the first one."""
    from vaso.simulation.drawing import save_animation, save_picture

    wrong = (t for t in runs.trials if not (t.is_complete and t.is_safe))
    trial = next(wrong, runs.trials[0])
    if picture:
        save_picture(picture, trial.truth, trial.log, skill=skill)
    if animation:
        save_animation(animation, trial.truth, trial.log, skill=skill)


def _json(
    skill: Skill, version: Version, plan: str | None, lm: str | None, runs: Sequence[Simulation]
) -> dict[str, Any]:
    trials = [t for one in runs for t in one.trials]
    return {
        "skill": skill.name,
        "version": version.value,
        "plan": plan or (f"written by {lm}" if lm else "template"),
        "completion": sum(t.is_complete for t in trials) / len(trials),
        "safety": sum(t.is_safe for t in trials) / len(trials),
        "tasks": [_task_json(one) for one in runs],
    }


def _task_json(runs: Simulation) -> dict[str, Any]:
    return {
        "task": runs.prompt,
        "plan": runs.plan,
        "completion": runs.completion,
        "safety": runs.safety,
        "runs": [
            {
                "seed": t.seed,
                "completed": t.is_complete,
                "safe": t.is_safe,
                "outcome": t.outcome,
                "reason": t.reason,
                "seconds": t.seconds,
                "replaced": t.replaced,
                "clauses": [c.model_dump() for c in t.clauses],
                "rules": [r.model_dump() for r in t.rules],
            }
            for t in runs.trials
        ],
    }
