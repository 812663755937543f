"""A guard against optimizing the task away: what can a plan do, and can a new plan still do it?

A skill that only says ``stop()`` for ever is safe and useless. Whether a plan *completes* its task
is measured in simulation (:mod:`vaso.simulation.tasks`, ``vaso simulate``), with a scene for each
task, and in metres. What is measured here needs no scene: from the transition system and the
platform's own dynamics (not from labelling code, which is under optimization itself) it takes

* for each action, the longest time that some behaviour of the plan executes it, and
* for plans that are a trajectory, the straight legs that it travels,

and compares them with those of the first plan for the same task. It notices that driving became
impossible, was cut to a moment, or that a leg of a square is gone. It does not notice a plan that
keeps all its actions and uses them to no purpose, nor does it know that the templates which
optimization starts from mostly do not complete their tasks either (docs/completion.md): it compares
with them, not with the prompt.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from vaso.optimizers.components import longest_weights
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Platform
from vaso.platforms.reading import read_command

KEEP = 0.2
SUSTAINED = 10
SAME_DIRECTION = 0.9
NEGLIGIBLE = 0.1

Vector = tuple[float, ...]


@dataclass(frozen=True)
class Purpose:
    """What a plan can do.

    Attributes:
        actions: For each action that the plan can execute (other than those that hold at rest): the
            greatest number of periods in which one behaviour executes it, ``inf`` for ever.
        legs: Displacements in metres, each straight; empty for reactive plans.
        moves: True when it is only known that the plan should move somewhere.
    """

    actions: Mapping[str, float] = field(default_factory=dict)
    legs: tuple[Vector, ...] = ()
    moves: bool = False


def purpose(system: TransitionSystem, platform: Platform) -> Purpose:
    """What a plan can do, from its transition system."""
    if platform.trajectory is not None:
        return Purpose(legs=_legs(system, platform))
    graph = [[edge.target for edge in edges] for edges in system.edges]
    commands = {state.command for state in system.states}
    known = {command: _actions(command, platform) for command in commands}
    doing = [known[state.command] for state in system.states]
    names = sorted(set().union(*doing))
    return Purpose({n: longest_weights(graph, [n in here for here in doing]) for n in names})


def purpose_of_text(plan: str, platform: Platform) -> Purpose:
    """What a plan that cannot be explored seems to be meant to do: the actions that it names."""
    actions = [p.name for p in platform.propositions if p.kind == "action"]
    at_rest = _actions(str(platform.rest), platform, rest=True)
    named = {n for n in actions if n not in at_rest and re.search(rf"\b{re.escape(n)}\s*\(", plan)}
    return Purpose({n: 1 for n in sorted(named)}, moves=platform.trajectory is not None)


def completion(reference: Purpose, candidate: Purpose | None) -> tuple[float, tuple[str, ...]]:
    """Compare a candidate with the reference.

    An action is kept if the candidate can execute it for ever, or at least a fifth as long as the
    reference (for ten periods, where the reference can do so for ever). A leg is kept if the
    candidate has one in the same direction, at least a fifth as long; the order does not matter.
    The bounds are that low because the first plan follows a faulty template and may not have the
    quantities of its task.

    Args:
        reference: What the first plan for the task can do.
        candidate: What the candidate can do; None if it cannot be explored.

    Returns:
        The fraction that is kept, in [0, 1], and what is lost, as phrases.
    """
    if candidate is None:
        return 0.0, ("the plan cannot be explored",)
    lost = [
        _lost_action(n, candidate) for n, t in reference.actions.items() if _gone(n, t, candidate)
    ]
    legs = _missing(reference.legs, candidate.legs)
    lost += [f"the leg {_show(leg)} m is not flown any more" for leg in legs]
    count = len(reference.actions) + len(reference.legs) + reference.moves
    if reference.moves and not candidate.legs:
        lost.append("the plan does not move any more")
    return (1.0 if count == 0 else 1.0 - len(lost) / count), tuple(lost)


def _gone(name: str, extent: float, candidate: Purpose) -> bool:
    needed = SUSTAINED if math.isinf(extent) else max(1.0, KEEP * extent)
    return candidate.actions.get(name, 0.0) < needed


def _lost_action(name: str, candidate: Purpose) -> str:
    periods = candidate.actions.get(name, 0.0)
    extent = f"for at most {periods:g} periods" if periods else "never"
    return f"{name} is executed {extent}"


def _missing(reference: tuple[Vector, ...], candidate: tuple[Vector, ...]) -> list[Vector]:
    missing, left = [], sorted(candidate, key=lambda leg: math.hypot(*leg))
    for leg in reference:
        found = next((other for other in left if _keeps(leg, other)), None)
        if found is None:
            missing.append(leg)
        else:
            left.remove(found)
    return missing


def _keeps(leg: Vector, other: Vector) -> bool:
    along = sum(a * b for a, b in zip(leg, other, strict=True))
    straight = along >= SAME_DIRECTION * math.hypot(*leg) * math.hypot(*other)
    return straight and math.hypot(*other) >= KEEP * math.hypot(*leg)


def _show(leg: Vector) -> str:
    return "(" + ", ".join(f"{x:g}" for x in leg) + ")"


def _actions(command: str, platform: Platform, *, rest: bool = False) -> frozenset[str]:
    """True action propositions of a command; those that hold at rest count only on request."""
    truth = _truth(command, platform)
    held = {
        p.name for p in platform.propositions if p.kind == "action" and truth.get(p.name) is True
    }
    return frozenset(held if rest else held - _actions(str(platform.rest), platform, rest=True))


def _truth(command: str, platform: Platform) -> dict[str, bool | float]:
    issued = read_command(command, platform)
    if issued is None:
        return {}
    found: dict[str, bool | float] = platform.dynamics.truth(
        platform.dynamics.step(platform.dynamics.initial(), issued)
    )
    return found


def _legs(system: TransitionSystem, platform: Platform) -> tuple[Vector, ...]:
    """Displacements along one behaviour, joined while the direction stays."""
    legs: list[Vector] = []
    for velocity in _velocities(system, platform):
        step = tuple(v * platform.dt for v in velocity)
        if not any(step):
            continue
        if legs and _same_direction(legs[-1], step):
            legs[-1] = tuple(a + b for a, b in zip(legs[-1], step, strict=True))
        else:
            legs.append(step)
    longest = max((math.hypot(*leg) for leg in legs), default=0.0)
    return tuple(leg for leg in legs if math.hypot(*leg) >= NEGLIGIBLE * longest)


def _velocities(system: TransitionSystem, platform: Platform) -> list[Vector]:
    state, seen = 0, {0}
    velocities: list[Vector] = []
    while True:
        state = system.edges[state][0].target
        if state in seen:
            return velocities
        seen.add(state)
        issued = read_command(system.states[state].command, platform)
        vectors = [v for _, v in issued.arguments if isinstance(v, tuple)] if issued else []
        velocities += vectors[:1]


def _same_direction(leg: Vector, step: Vector) -> bool:
    along = sum(a * b for a, b in zip(leg, step, strict=True))
    return along >= 0.999 * math.hypot(*leg) * math.hypot(*step)
