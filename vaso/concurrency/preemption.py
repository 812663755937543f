"""One skill interrupts another on the same robot: stop for a person while driving.

The plans run in layers, the most urgent first. In every state the first layer whose condition
holds is in charge: the command of the next state comes from its plan. The plans below it are
suspended, and their programs do not advance. See :mod:`vaso.concurrency.layers` for how that is
explored.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

from vaso.concurrency.layers import explore_layers
from vaso.concurrency.members import Explored, Given, Member, Part, identifier, parts_of
from vaso.errors import SkillError
from vaso.ltl import Formula, is_propositional
from vaso.ltl.parser import parse
from vaso.plan.explore import Budget
from vaso.plan.transition_system import TransitionSystem

__all__ = ["Layer", "Preemption", "Resume", "preempt"]

Resume = Literal["continue", "restart"]


@dataclass(frozen=True)
class Layer:
    """A plan that interrupts those below it.

    Attributes:
        member: The skill and its plan.
        when: The condition, about one step; None for the lowest layer.
        resume: How the plans below go on afterwards: where they were, or from their first line.
    """

    member: Member
    when: Formula | None = None
    resume: Resume = "continue"


@dataclass(frozen=True)
class Preemption:
    """Several plans that take turns with one robot; made by :func:`preempt`.

    Attributes:
        layers: The plans, the most urgent first; the last one has no condition.
        name: What formulas call the robot.
    """

    layers: tuple[Layer, ...]
    name: str

    def named(self, name: str) -> Preemption:
        """The same under another name."""
        return replace(self, name=identifier(name))

    def explore(self, formulas: Sequence[Formula] = (), budget: Budget | None = None) -> Explored:
        """Every behaviour of the plans together.

        A proposition of one plan's skill is called ``plan.proposition``. One that has the same
        value for every plan is also called by its own name. ``plan.in_charge`` tells which plan
        the command in force comes from.

        Args:
            formulas: Formulas that will be checked besides the skills' own rules.
            budget: Bounds of the exploration.

        Raises:
            PlanError: A plan is not a program of its skill.
            LabellingError: Labelling code does not run or does not fit the platform.
            SkillError: A condition speaks of something that no plan's skill knows.
        """
        return explore_layers(self.name, self.layers, formulas, budget)

    def system(self, *, budget: Budget | None = None) -> TransitionSystem:
        """The transition system of the plans together; see :meth:`explore`."""
        return self.explore((), budget).system


def preempt(
    high: Given,
    low: Given,
    *,
    when: str | Formula,
    resume: Resume = "continue",
    name: str | None = None,
) -> Preemption:
    """Let one plan interrupt another on the same robot.

    Where the condition holds in one step, the command of the next step comes from ``high``, and
    ``low`` is suspended. ``high`` starts at its first line each time. When the condition no longer
    holds, ``low`` is in charge again: the command that it sent last comes into force again if it
    was waiting, or else its program goes on. A plan that has sent no command yet commands the
    robot to rest.

    Args:
        high: The plan that interrupts: a member in any form that :func:`compose` takes, or a
            preemption, whose layers then come first.
        low: The plan that is interrupted; a member, or a preemption.
        when: A formula about one step over propositions of ``low`` (or of ``high``, where ``low``
            has none of that name), such as ``people_observed``.
        resume: Whether ``low`` continues where it was, or restarts from its first line.
        name: What formulas call the robot; by default the name of ``low``.

    Raises:
        FormulaError: The condition does not parse.
        SkillError: It speaks of more than one step, names clash, or the plans are for different
            robots.
    """
    upper, lower = _layers(high), _layers(low)
    condition = parse(when) if isinstance(when, str) else when
    if not is_propositional(condition):
        raise SkillError(
            f"the condition '{condition}' speaks of more than one step",
            expected="a formula without temporal operators, such as people_observed",
        )
    if resume not in get_args(Resume):
        raise SkillError(
            f"there is no way to resume called '{resume}'",
            expected=f"one of {', '.join(get_args(Resume))}",
        )
    if len(upper) > 1:
        raise SkillError(
            "the interrupting plan is itself a preemption",
            hint="preempt the lower plan first: preempt(most_urgent, preempt(urgent, plan, …), …)",
        )
    layers = (replace(upper[0], when=condition, resume=resume), *lower)
    _check_layers(layers)
    return Preemption(layers, identifier(_name(low, lower) if name is None else name))


def _layers(given: Given) -> tuple[Layer, ...]:
    part: Part = parts_of([given])[0]
    if isinstance(part, Preemption):
        return part.layers
    if isinstance(part, Member):
        return (Layer(part),)
    raise SkillError(
        f"'{part.name}' has no plan that could be suspended",
        expected="a skill with a plan, or a preemption",
    )


def _name(low: Given, lower: Sequence[Layer]) -> str:
    return low.name if isinstance(low, Preemption) else lower[-1].member.name


def _check_layers(layers: Sequence[Layer]) -> None:
    names = [layer.member.name for layer in layers]
    twice = next((n for n in names if names.count(n) > 1), None)
    if twice:
        raise SkillError(
            f"two plans are called '{twice}'", hint="name them: vaso.Member(…, name='waiting')"
        )
    robots = {layer.member.platform.name for layer in layers}
    if len(robots) > 1:
        raise SkillError(
            f"the plans are for different robots ({', '.join(sorted(robots))})",
            hint="plans on different robots run at the same time: vaso.compose",
        )
