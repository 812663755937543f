"""Would a plan have done the same where a violation was recorded?"""

from __future__ import annotations

from vaso.errors import VasoError
from vaso.execution import IdealRobot, execute
from vaso.monitoring.recorded.recording import Recording
from vaso.plan.transition_system import Scalar
from vaso.platforms import Issued, Platform
from vaso.skill import Skill

__all__ = ["would_repeat"]

DECIMALS = 6


def would_repeat(
    recording: Recording, step: int, skill: Skill, plan: str, platform: Platform
) -> bool:
    """Whether a plan sends the recorded commands, given the recorded sensor readings.

    A sensor that was not recorded in a state reads the first value of its domain.

    Args:
        recording: The recording.
        step: The last state that matters.
        skill: The skill.
        plan: The plan's text.
        platform: The robot's platform.

    Returns:
        False also where the plan does not run, or a command was not recorded.
    """
    samples = recording.samples[: step + 1]
    recorded = [s.issued for s in samples[1:]]
    if any(command is None for command in recorded):
        return False

    def sense(sensor: str, state: int) -> Scalar:
        readings = samples[min(state, len(samples) - 1)].sensors
        return readings[sensor] if sensor in readings else _first(platform, sensor)

    robot = IdealRobot(platform, sense)
    try:
        execute(skill, plan, robot, seconds=step * platform.dt)
    except VasoError:
        return False
    sent = [*robot.commands[:step]]
    last = sent[-1] if sent else platform.rest  # the last command goes on when a plan has ended
    sent += [last] * (step - len(sent))
    return all(_same(a, b) for a, b in zip(sent, recorded, strict=True) if b is not None)


def _first(platform: Platform, sensor: str) -> Scalar:
    spec = platform.sensor_of(sensor)
    return spec.domain[0] if spec else False


def _same(one: Issued, other: Issued) -> bool:
    return one.name == other.name and _rounded(one) == _rounded(other)


def _rounded(issued: Issued) -> list[tuple[str, object]]:
    return [
        (n, tuple(round(x, DECIMALS) for x in v) if isinstance(v, tuple) else round(v, DECIMALS))
        for n, v in issued.arguments
    ]
