"""What several plans on one robot run on, and what they are held to."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import TYPE_CHECKING

from vaso.concurrency.members import Member
from vaso.concurrency.naming import rename
from vaso.ltl import Formula, propositions, variables
from vaso.plan.explore import Session as Session
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Dynamics, Platform
from vaso.skill import Rule

if TYPE_CHECKING:
    from vaso.concurrency.preemption import Layer

__all__ = ["Session", "layered_platform", "own_rules", "session_of"]


def session_of(member: Member, needed: set[str]) -> Session:
    """The sandboxed programs of one plan.

    Args:
        member: The skill and its plan.
        needed: Propositions that rules besides the skill's own mention.
    """
    rules = [r.formula for r in (*member.skill.rules, *member.skill.assumptions)]
    own = {n for f in rules for n in (*propositions(f), *variables(f))}
    asked = {name.removeprefix(f"{member.name}.") for name in needed}
    return Session(member.plan, member.skill, member.platform, own | asked)


def own_rules(layers: Sequence[Layer], which: str, system: TransitionSystem) -> tuple[Rule, ...]:
    """The rules or assumptions of each skill; what several skills say alike is said once."""
    found: dict[Formula, Rule] = {}
    for layer in layers:
        own = f"{layer.member.name}.{{}}".format

        def full(name: str, own: Callable[[str], str] = own) -> str:
            return name if name in system.propositions else own(name)

        for rule in getattr(layer.member.skill, which):
            formula = rename(rule.formula, full)
            found.setdefault(formula, Rule(text=str(formula), role=rule.role, note=rule.note))
    return tuple(found.values())


def layered_platform(layers: Sequence[Layer]) -> Platform:
    """The robot, with the propositions of each plan besides its own."""
    robot = layers[-1].member.platform
    names = [layer.member.name for layer in layers]
    qualified = [
        p.model_copy(update={"name": f"{name}.{p.name}"})
        for name in names
        for p in robot.propositions
    ]
    groups = [tuple(f"{n}.{a}" for a in group) for n in names for group in robot.exclusions]
    return robot.model_copy(
        update={
            "propositions": (*robot.propositions, *qualified),
            "exclusions": (*robot.exclusions, *groups),
            "dynamics": _LayeredDynamics(robot.dynamics, names),
        }
    )


class _LayeredDynamics:
    """The robot's dynamics; what is true of it is true for every plan on it.

    Args:
        dynamics: The robot's own.
        names: The names of the plans.
    """

    def __init__(self, dynamics: Dynamics, names: Sequence[str]) -> None:
        self._dynamics, self._names = dynamics, names
        self.initial = dynamics.initial
        self.step = dynamics.step

    def truth(self, state: Hashable) -> dict[str, bool | float]:
        """The true propositions, also under the name of each plan."""
        own = self._dynamics.truth(state)
        return own | {f"{name}.{p}": value for name in self._names for p, value in own.items()}
