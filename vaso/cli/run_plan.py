"""``vaso run``: a verified plan on a robot, or on its simulator."""

from __future__ import annotations

import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vaso.cli.common import (
    ExitCode,
    JsonOption,
    NameOption,
    PlatformOption,
    SkillArgument,
    Version,
    VersionOption,
    console,
    emit,
    get_plan,
    get_skill,
    leave,
)
from vaso.errors import PlanError

if TYPE_CHECKING:
    from vaso.execution import Robot, RunLog
    from vaso.monitoring import Shield, Watch
    from vaso.plan.model import Plan
    from vaso.skill import Skill


def run(
    skill: SkillArgument,
    plan: Annotated[
        str | None,
        typer.Option(help="A Python file with the plan; - for stdin; by default the template."),
    ] = None,
    task: Annotated[
        str | None, typer.Option(help="What to do, in words; a plan is written for it.")
    ] = None,
    robot: Annotated[
        str, typer.Option(help="sim, jackal, px4, or ideal: the model itself.")
    ] = "sim",
    connect: Annotated[
        str | None,
        typer.Option(help="Where the robot is: udp:127.0.0.1:14540, or a velocity topic."),
    ] = None,
    scene: Annotated[
        Path | None, typer.Option(help="The simulator's world, a YAML file; empty by default.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the simulator.")] = 0,
    seconds: Annotated[
        float | None, typer.Option(min=0.0, help="Stop after this time; 120 s in a simulator.")
    ] = None,
    log: Annotated[Path | None, typer.Option(help="File for the log; by default in runs/.")] = None,
    no_shield: Annotated[
        bool, typer.Option("--no-shield", help="Let every command of the plan go out.")
    ] = False,
    unverified: Annotated[
        bool, typer.Option("--unverified", help="Run a plan that is not verified.")
    ] = False,
    picture: Annotated[
        Path | None, typer.Option(help="Draw the run: a .png, .svg or .pdf file.")
    ] = None,
    animation: Annotated[
        Path | None, typer.Option(help="Animate the run: a .gif or .html file.")
    ] = None,
    lm: Annotated[
        str | None, typer.Option(help="With --task: a language model that writes the plan.")
    ] = None,
    version: VersionOption = Version.VERIFIED,
    name: NameOption = None,
    platform: PlatformOption = None,
    as_json: JsonOption = False,
) -> None:
    """Run a plan on a robot: verify it first, watch every step, and stop the robot at the end.

    Exit code 0: the plan has ended (or its time was over) and no rule was violated on the way, 1: a
    rule was violated, the run was aborted, or the plan was refused because it violates a rule, 2:
    bad input, 3: the plan was refused because its verdict is not known.
    """
    from vaso.cli.running import Watching, summary
    from vaso.execution import execute
    from vaso.modules.robots.opening import get_robot

    if picture or animation:
        from vaso.simulation.drawing import check_names

        check_names(picture, animation)
    chosen = get_skill(skill, version, name, platform)
    wanted = _plan(chosen, plan, task, lm, is_real=robot in ("jackal", "px4"))
    machine = get_robot(robot, platform or chosen.platform, connect=connect, scene=scene, seed=seed)
    verdict = _verified(chosen, wanted, platform, unverified)
    path = log or _default_log(chosen.name)
    shield = None if no_shield else _shield(chosen, machine)
    with Watching(chosen, machine, quiet=as_json) as watching:
        if hasattr(machine, "on_event"):
            machine.on_event = watching.tell
        done = execute(
            chosen,
            wanted,
            machine,
            shield=shield,
            seconds=SIMULATED_SECONDS if seconds is None and machine.is_simulated else seconds,
            log=path,
            on_record=watching,
            verdict=verdict,
        )
    if as_json:
        emit(_data(done, watching.watch, shield, path))
    else:
        unguarded = shield.unguarded if shield else ()
        console().print(summary(done, watching.watch, machine.platform, path, unguarded))
    _draw(done, machine, picture, animation, chosen)
    leave(_exit_code(done, watching.watch))


SIMULATED_SECONDS = 120.0
"""How long a run in a simulator may be, on its clock."""


def _plan(
    skill: Skill, path: str | None, task: str | None, lm: str | None, *, is_real: bool
) -> Plan:
    """The plan that the user named, or one for the task.

    Raises:
        PlanError: The plan cannot be read, or the task was not understood: nothing of it, or not
            all of it, for a real robot.
    """
    from vaso.cli.plan import make_filling, say_what_is_missing
    from vaso.plan.model import Plan

    if path is not None and task is not None and lm is not None:
        raise PlanError("--lm writes a plan, and --plan names one", hint="leave one of them out")
    if path is not None:
        return get_plan(path, task)
    if task is not None:
        filling = make_filling(skill, task, lm)
        nothing = lm is None and not filling.filled and bool(filling.kept)
        if (filling.unused and (nothing or is_real)) or (nothing and is_real):
            told = ", ".join(f"'{part}'" for part in filling.unused) or f"'{task}'"
            raise PlanError(
                f"the planner without a model does not understand {told}",
                hint=f'look at what `vaso plan {skill.name} "…"` makes of it, and run that with '
                "--plan; or let a language model write the plan (--lm)",
            )
        say_what_is_missing(filling)
        return filling.plan
    return Plan(source=skill.plan_template)


def _verified(skill: Skill, plan: Plan, platform: str | None, unverified: bool) -> str:
    """The plan's verdict. Where it is none to run with, the command ends here.

    Raises:
        PlanError: The plan is not a program of the skill.
    """
    from vaso.cli.verify import exit_code
    from vaso.memo import default_memo, verify_remembered

    result = verify_remembered(skill, plan, memo=default_memo(), platform=platform)
    code = exit_code(result)
    if code is ExitCode.BAD_INPUT:
        assert result.problem is not None
        raise PlanError(result.problem.message, source=plan.name, line=result.problem.line)
    if code is not ExitCode.HOLDS and not unverified:
        console(stderr=True).print(result)
        console(stderr=True).print(
            "The plan is not verified, so it was not run. With --unverified it is run all the same,"
            " with the shield between it and the robot.",
            style="bold red",
        )
        leave(code)
    return result.verdict.value


def _shield(skill: Skill, robot: Robot) -> Shield:
    from vaso.monitoring import Shield

    return Shield(skill, robot.platform)


def _default_log(skill: str) -> Path:
    """A file in ``runs`` that is not there yet."""
    now = datetime.datetime.now().strftime("%Y%m%d-%H%M%S")
    return Path("runs") / f"{skill}-{now}.jsonl"


def _data(log: RunLog, watch: Watch, shield: Shield | None, path: Path) -> dict[str, Any]:
    assert log.ending is not None
    last = log.records[-1] if log.records else None
    return {
        "skill": log.header.skill,
        "robot": log.header.robot,
        "verdict": log.header.verdict,
        "outcome": log.ending.outcome,
        "reason": log.ending.reason,
        "seconds": last.time if last else 0.0,
        "states": len(log.records),
        "rules": [
            {
                "rule": s.rule.text,
                "truth": s.truth.value,
                "state": s.step,
                "awaited": [str(f) for f in s.awaited],
                "problem": s.problem,
            }
            for s in watch.statuses
        ],
        "interventions": [
            {"step": r.step, "time": r.time, **r.intervention.model_dump()}
            for r in log.records
            if r.intervention is not None
        ],
        "unguarded": [
            {"rule": rule.text, "reason": why} for rule, why in (shield.unguarded if shield else ())
        ],
        "measured": last.measured if last else {},
        "log": str(path),
    }


def _exit_code(log: RunLog, watch: Watch) -> ExitCode:
    """What a run's exit code says."""
    assert log.ending is not None
    from vaso.execution.run import INTERRUPTED
    from vaso.monitoring import Truth

    if log.ending.reason == INTERRUPTED:
        return ExitCode.INTERRUPTED
    violated = any(s.truth is Truth.VIOLATED for s in watch.statuses)
    failed = violated or log.ending.outcome == "aborted"
    return ExitCode.REFUTED if failed else ExitCode.HOLDS


def _draw(
    log: RunLog, robot: Robot, picture: Path | None, animation: Path | None, skill: Skill
) -> None:
    if picture or animation:
        from vaso.simulation import drawing

        drawing.draw(log, robot, picture=picture, animation=animation, skill=skill)
        for path in filter(None, (picture, animation)):
            console(stderr=True).print(f"  drawn: {path}", style="dim", soft_wrap=True)
