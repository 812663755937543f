"""A robot by its name: the simulator of a platform, its model, or the adapter of a real one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vaso.errors import RobotError
from vaso.execution import IdealRobot, Robot
from vaso.platforms import Platform, get_platform

__all__ = ["KINDS", "get_robot"]

KINDS = {
    "sim": "the simulator of the skill's platform",
    "ideal": "the platform's model: no lag, no noise, sensors that see nothing",
    "jackal": "a Clearpath Jackal over ROS 2",
    "px4": "a PX4 multicopter over MAVLink",
}
REAL = ("jackal", "px4")


def get_robot(
    kind: str,
    platform: str | Platform,
    *,
    connect: str | None = None,
    scene: str | Path | None = None,
    seed: int = 0,
    **settings: Any,
) -> Robot:
    """Make a robot; nothing is connected yet.

    Args:
        kind: One of :data:`KINDS`.
        platform: The skill's platform, which the robot must be of.
        connect: Where a real robot is: ``udp:127.0.0.1:14540`` for PX4, a velocity topic such as
            ``/j100_0000/cmd_vel`` for the Jackal.
        scene: File of the scene for a simulator; by default an empty floor, or still air.
        seed: Seed of a simulator.
        settings: Further settings of the adapter.

    Raises:
        RobotError: There is no such kind, or it is a robot of another platform.
        VasoError: The scene cannot be read.
        MissingDependencyError: The adapter's package is not installed.
    """
    robot = get_platform(platform)
    if kind not in KINDS:
        raise RobotError(f"there is no robot '{kind}'", expected=f"one of {', '.join(KINDS)}")
    if kind not in REAL and connect is not None:
        raise RobotError(
            f"a simulated robot is not connected to {connect}",
            hint=f"--robot {robot.name} is the real one" if robot.name in REAL else None,
        )
    if kind in REAL:
        if robot.name != kind:
            raise RobotError(
                f"the skill is for platform {robot.name}, and the robot is a {kind}",
                hint="choose --robot sim, or a skill of that platform",
            )
        return _real(kind, connect, settings)
    if kind == "ideal":
        return IdealRobot(robot)
    return _simulated(robot, scene, seed, settings)


def _real(kind: str, connect: str | None, settings: dict[str, Any]) -> Robot:
    if connect is not None:
        settings = {"connect": connect, **settings}
    if kind == "px4":
        from vaso.modules.robots.px4 import PX4Mavlink

        return PX4Mavlink(**settings)
    from vaso.modules.robots.jackal import JackalROS

    return JackalROS(**settings)


def _simulated(
    platform: Platform, scene: str | Path | None, seed: int, settings: dict[str, Any]
) -> Robot:
    from vaso.simulation import AirScene, JackalSim, PX4Sim, Scene, load_scene

    world = load_scene(scene) if scene is not None else None
    if platform.name == "jackal" and (world is None or isinstance(world, Scene)):
        return JackalSim(world, seed=seed, **settings)
    if platform.name == "px4" and (world is None or isinstance(world, AirScene)):
        return PX4Sim(world, seed=seed, **settings)
    if platform.name in ("jackal", "px4"):
        raise RobotError("the scene is for another platform", source=str(scene))
    raise RobotError(
        f"there is no simulator of platform {platform.name}",
        hint="--robot ideal runs a plan on the platform's own model",
    )
