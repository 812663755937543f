"""``vaso robot``: what real robots need on this computer, and whether they can be reached."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vaso.cli.common import ExitCode, JsonOption, console, emit, leave

if TYPE_CHECKING:
    from vaso.execution import Health
    from vaso.modules.robots.ros_environment import RosPython

app = typer.Typer(help="Real robots: set up what they need here, and see whether they are there.")


class Kind(StrEnum):
    """A real robot."""

    JACKAL = "jackal"
    PX4 = "px4"


KindArgument = Annotated[Kind, typer.Argument(help="jackal or px4", show_default=False)]


@app.command("list")
def list_robots(as_json: JsonOption = False) -> None:
    """The robots that `vaso run --robot` takes, and whether they can be used here."""
    from vaso.modules.robots.opening import KINDS

    rows = {name: (what, _readiness(name)) for name, what in KINDS.items()}
    if as_json:
        emit([{"robot": n, "what": w, "ready": not r, "needs": r} for n, (w, r) in rows.items()])
        return
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("robot", no_wrap=True)
    table.add_column("what it is", overflow="fold")
    table.add_column("here", overflow="fold")
    for name, (what, needs) in rows.items():
        table.add_row(name, what, needs or "ready")
    console().print(table)


@app.command()
def setup(
    robot: KindArgument,
    path: Annotated[
        Path | None,
        typer.Option(help="Folder for the environment; by default ~/.local/share/vaso/ros."),
    ] = None,
    python: Annotated[
        str | None,
        typer.Option(help="Use the Python of a ROS installation instead, with ROS sourced."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Install what a robot needs, in an environment of its own.

    The Jackal needs ROS 2: about 200 MB of packages from PyPI, within a minute,
    or an installation: `source /opt/ros/jazzy/setup.bash`, and then
    `--python /usr/bin/python3`. The PX4 needs pymavlink in VASO's environment.
    """
    from vaso.errors import RobotError

    if robot is Kind.PX4:
        if needs := _readiness("px4"):
            raise RobotError("the px4 needs pymavlink, in this environment", hint=needs)
        _tell({"robot": "px4", "ready": True}, "px4: pymavlink is here; nothing to set up", as_json)
        return
    from vaso.modules.robots.ros_environment import use_ros
    from vaso.modules.robots.ros_setup import set_up_ros

    if path is not None and python is not None:
        raise RobotError("--path makes an environment and --python uses one", hint="choose one")
    out = console(stderr=as_json)
    say = lambda text: out.print(text, soft_wrap=True)  # noqa: E731
    ros = use_ros(python) if python else set_up_ros(path, say=say)
    _tell({"robot": "jackal", "ready": True, **_facts(ros)}, _sentence(ros), as_json)


@app.command()
def check(
    robot: KindArgument,
    connect: Annotated[
        str | None,
        typer.Option(help="Where it is: a velocity topic such as /j100_0000/cmd_vel, or a URL."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Connect to a robot and say what it says of itself. Nothing moves."""
    from vaso.modules.robots.opening import get_robot

    found = get_robot(robot.value, robot.value, connect=connect)
    try:
        found.connect()
        health = found.health()
    finally:
        found.close()
    if as_json:
        emit({"robot": found.name, "ok": health.ok, "problems": health.problems, **_plain(health)})
    else:
        out = console()
        out.print(f"{found.name}: {'ready' if health.ok else 'not ready'}", soft_wrap=True)
        for line in (*health.problems, *(f"{k}: {v}" for k, v in health.details.items())):
            out.print(f"  {line}", soft_wrap=True)
    if not health.ok:
        leave(ExitCode.REFUTED)


def _tell(data: dict[str, Any], text: str, as_json: bool) -> None:
    if as_json:
        emit(data)
    else:
        console().print(text, soft_wrap=True)


def _plain(health: Health) -> dict[str, Any]:
    return {"details": dict(health.details)}


def _facts(ros: RosPython) -> dict[str, Any]:
    from dataclasses import asdict

    return asdict(ros)


def _sentence(ros: RosPython) -> str:
    vision = "" if ros.vision else "\nvision_msgs is not there: detections come as JSON"
    return (
        f"jackal: ready. ROS 2 {ros.distribution} ({ros.middleware}), "
        f"Python {ros.version}: {ros.python}{vision}"
    )


def _readiness(name: str) -> str:
    """What is missing here for a robot, as the command that gets it; empty if nothing is."""
    from importlib.util import find_spec

    from vaso.errors import RobotError

    if name == "px4" and find_spec("pymavlink") is None:
        return "make everything"
    if name == "jackal":
        from vaso.modules.robots.ros_environment import find_ros

        try:
            find_ros()
        except RobotError as error:
            return error.hint or error.message
    return ""
