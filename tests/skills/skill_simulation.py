"""Run skill templates in plain CPython, apart from the sandbox, on given sensor readings."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from typing import Any

from vaso.ltl import holds
from vaso.platforms import get_platform
from vaso.skill import Skill

JACKAL = get_platform("jackal")
PX4 = get_platform("px4")
QUIET = frozenset[str]()


class _Horizon(Exception):
    pass


class Jackal:
    """A robot whose detector sees, in step t, the objects in ``seen[t]``, and then nothing."""

    def __init__(self, seen: Sequence[frozenset[str]], horizon: int) -> None:
        self.seen, self.horizon = seen, horizon
        self.commands = [JACKAL.rest]

    def velocity_publisher(self, linear: float, angular: float = 0.0) -> None:
        self.commands.append(JACKAL.commands[0].issue((linear, angular), {}))
        if len(self.commands) > self.horizon:
            raise _Horizon

    def yolo_listener(self, object_name: str) -> bool:
        return object_name in self.at(len(self.commands) - 1)

    def at(self, step: int) -> frozenset[str]:
        return self.seen[step] if step < len(self.seen) else QUIET


def run_jackal(
    skill: Skill, seen: Sequence[frozenset[str]], *, horizon: int, constants: dict[str, Any]
) -> list[dict[str, bool | float]]:
    """The labelled states of one run; after the plan's end its last command goes on."""
    robot = Jackal(seen, horizon)
    names: dict[str, Any] = {
        "velocity_publisher": robot.velocity_publisher,
        "yolo_listener": robot.yolo_listener,
    }
    exec(skill.labelling_code, names)
    with contextlib.suppress(_Horizon):
        exec(with_constants(skill.plan_template, constants), names)
    commands = robot.commands + [robot.commands[-1]] * (horizon - len(robot.commands) + 1)
    target = names.get("TARGET", "target")
    return [
        JACKAL.dynamics.truth(command)
        | {f"{what}_observed": what in robot.at(t) for what in ("people", "obstacle")}
        | {"target_observed": target in robot.at(t)}
        for t, command in enumerate(commands)
    ]


def fly(skill: Skill, constants: dict[str, Any]) -> tuple[list[Any], list[dict[str, float]]]:
    """The set-points of a flight from the one at rest, and the true values after each."""
    names: dict[str, Any] = {}
    exec(skill.labelling_code, names)
    exec(with_constants(skill.plan_template, constants), names)
    plan = names["vel_traj"]
    velocities = [(0.0, 0.0, 0.0), *plan, plan[-1]]
    state, truths = PX4.dynamics.initial(), []
    for index, velocity in enumerate(velocities):
        if index:
            state = PX4.dynamics.step(state, PX4.commands[0].issue((velocity,), {}))
        truths.append(PX4.dynamics.truth(state))
    return velocities, truths


def with_constants(template: str, constants: dict[str, Any]) -> str:
    """The template with other values for its top-level constants."""
    lines = template.split("\n")
    for name, value in constants.items():
        [at] = [i for i, line in enumerate(lines) if line.startswith(f"{name} = ")]
        lines[at] = f"{name} = {value!r}"
    return "\n".join(lines)


def broken_rules(skill: Skill, steps: Sequence[Any]) -> list[str]:
    """The rules that a run violates, taking its last state to go on for ever."""
    return [r.text for r in skill.rules if not holds(r.formula, steps, len(steps) - 1)]
