"""Which sensors and actions a plan uses, and which of them make a difference."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from vaso.feasibility.roles import Role, role_finder
from vaso.ltl import Formula, Proposition, propositions
from vaso.plan.transition_system import Edge, TransitionSystem
from vaso.platforms import Platform
from vaso.skill import Skill
from vaso.verifiers.reduction import reduce

__all__ = ["idle_actions", "unheeded", "unread"]

_COMMAND = "__command_{}__"


def unread(system: TransitionSystem, formulas: Sequence[Formula]) -> tuple[str, ...]:
    """Observations that some formula speaks of, and of whose sensors the plan reads none."""
    read = _read(system)
    behind = _sensors_behind(system)
    names = _names(formulas)
    return tuple(n for n in names if n in behind and not behind[n] & read)


def unheeded(system: TransitionSystem, formulas: Sequence[Formula]) -> tuple[str, ...]:
    """Observations that the plan reads, and whose value never changes what the robot does.

    Two states of the plan are the same here when they lead to the same commands, whatever the
    sensors say from then on. Names that formulas use are preferred to those of raw sensors.
    """
    if any(state.cut for state in system.states):
        return ()
    mattering = _mattering(_by_command(system))
    behind = _sensors_behind(system)
    wanted = set(_names(formulas))
    order = sorted(behind, key=lambda name: (name in wanted, len(behind[name]) == 1))
    named = {sensor: name for name in order for sensor in behind[name]}
    return tuple(dict.fromkeys(named.get(s, s) for s in sorted(_read(system) - mattering)))


def idle_actions(
    system: TransitionSystem, formulas: Sequence[Formula], skill: Skill, robot: Platform
) -> tuple[str, ...]:
    """Actions that some formula speaks of, and that the plan never takes.

    That a robot stands still before the plan's first command does not count.
    """
    role = role_finder(skill, robot)
    acting = [s for s in system.states if s.api or s.line is not None]
    return tuple(
        name
        for name in _names(formulas)
        if role(name) is Role.ROBOT
        and isinstance(system.states[0].labels.get(name), bool)
        and not any(s.labels.get(name) for s in acting)
    )


def _names(formulas: Iterable[Formula]) -> list[str]:
    return sorted({n for f in formulas for n in propositions(f)})


def _read(system: TransitionSystem) -> set[str]:
    """The raw sensors that the plan reads."""
    return {sensor for out in system.edges for edge in out for sensor in edge.guard}


def _sensors_behind(system: TransitionSystem) -> dict[str, set[str]]:
    """The raw sensors that each observation depends on."""
    found: dict[str, set[str]] = {}
    for state in system.states:
        for name, cases in state.observed.items():
            found.setdefault(name, set()).update(s for c in cases for s in c.guard)
    return found


def _by_command(system: TransitionSystem) -> TransitionSystem:
    """The smallest system with the same commands."""
    commands = sorted({state.command for state in system.states})
    bits = max(1, (len(commands) - 1).bit_length())
    codes = {
        command: {_COMMAND.format(b): bool(number >> b & 1) for b in range(bits)}
        for number, command in enumerate(commands)
    }
    states = tuple(s.relabelled(codes[s.command], {}) for s in system.states)
    visible = [Proposition(_COMMAND.format(b)) for b in range(bits)]
    return reduce(replace(system, states=states), visible)


def _mattering(system: TransitionSystem) -> set[str]:
    """Sensors of which, in some state, two values lead to different states."""
    return {
        sensor
        for out in system.edges
        for number, one in enumerate(out)
        for other in out[:number]
        if one.target != other.target
        for sensor in _only_difference(one, other)
    }


def _only_difference(one: Edge, other: Edge) -> Iterable[str]:
    """The sensor on which two guards disagree, if it is a single one."""
    differing = [s for s, v in one.guard.items() if s in other.guard and other.guard[s] != v]
    return differing if len(differing) == 1 else ()
