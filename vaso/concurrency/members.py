"""Who takes part in a composition: skills with plans, each under a name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol, TypeAlias, runtime_checkable

from vaso.errors import SkillError
from vaso.ltl import Formula
from vaso.ltl.vocabulary import is_reserved
from vaso.plan.explore import Budget, compile_plan
from vaso.plan.model import Plan
from vaso.plan.transition_system import TransitionSystem
from vaso.platforms import Platform, get_platform
from vaso.skill import Rule, Skill
from vaso.verification.assumptions import require_sensors_only

__all__ = ["Explored", "Given", "Member", "Part", "SystemPart", "identifier", "parts_of"]

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)
_FORMS = "a skill, (skill, plan), a Member, a Preemption or a TransitionSystem"

Given: TypeAlias = Any
"""What stands for a member: a Member, a Preemption, a skill or its name, a pair (skill, plan), a
mapping with these entries, or a TransitionSystem."""


@dataclass(frozen=True)
class Explored:
    """A member with every behaviour that it has on its own.

    Attributes:
        name: The member's name.
        system: Its transition system; propositions have the names of its skill.
        rules: What its plan must satisfy by itself, over these names.
        assumptions: What its skill trusts the sensors to do.
        platform: What is known of its robot; None where there is only a system.
        plans: The text of each plan that it runs, by name; one plan has the member's name.
        missing: Propositions without a known value, each with the reason.
    """

    name: str
    system: TransitionSystem
    rules: tuple[Rule, ...] = ()
    assumptions: tuple[Rule, ...] = ()
    platform: Platform | None = None
    plans: Mapping[str, str] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)


@runtime_checkable
class Part(Protocol):
    """Something that can be composed."""

    @property
    def name(self) -> str:
        """Its name in formulas."""
        ...

    def explore(self, formulas: Sequence[Formula], budget: Budget | None) -> Explored:
        """Every behaviour that it has on its own.

        Args:
            formulas: Formulas over its propositions that will be checked besides its own rules.
            budget: Bounds of the exploration.
        """
        ...


@dataclass(frozen=True)
class Member:
    """A skill and a plan on a robot of their own.

    Args:
        skill: The skill, or the name or path of one.
        plan: The plan, its text, or the path of its file; by default the skill's template.
        name: What formulas call the member; by default the skill's name with underscores.
        platform: Overrides the skill's platform.

    Raises:
        SkillError: There is no such skill, or the name cannot be used in a formula.
        PlanError: The plan's file cannot be read.
        PlatformError: There is no such platform.
    """

    skill: Skill
    plan: Plan
    name: str
    platform: Platform

    def __init__(
        self,
        skill: Skill | str | Path,
        plan: Plan | str | Path | None = None,
        *,
        name: str | None = None,
        platform: str | Path | Platform | None = None,
    ) -> None:
        found = _skill(skill)
        object.__setattr__(self, "skill", found)
        object.__setattr__(self, "plan", _plan(plan, found))
        object.__setattr__(self, "name", identifier(found.name if name is None else name))
        object.__setattr__(self, "platform", get_platform(platform or found.platform))

    def explore(self, formulas: Sequence[Formula], budget: Budget | None) -> Explored:
        """See :class:`Part`.

        Raises:
            PlanError: The plan is not a program of the skill.
            LabellingError: The labelling code does not run or does not fit the platform.
            SkillError: An assumption of the skill is not about sensors.
        """
        system = compile_plan(
            self.plan, self.skill, platform=self.platform, formulas=formulas, budget=budget
        )
        source = self.skill.source or self.skill.name
        require_sensors_only(self.skill.assumptions, system, self.platform, source)
        return Explored(
            self.name,
            system,
            rules=self.skill.rules,
            assumptions=self.skill.assumptions,
            platform=self.platform,
            plans={self.name: self.plan.source},
        )


@dataclass(frozen=True)
class SystemPart:
    """A transition system that exists already, under a name."""

    name: str
    system: TransitionSystem

    def explore(self, formulas: Sequence[Formula], budget: Budget | None) -> Explored:
        """See :class:`Part`; there is nothing left to explore."""
        return Explored(self.name, self.system, plans={self.name: self.system.source})


def parts_of(given: Mapping[str, Given] | Iterable[Given]) -> list[Part]:
    """The members of a composition, with different names.

    Args:
        given: Members in one of the forms of :data:`Given`, or a mapping of names to them.

    Raises:
        SkillError: There are none, two have the same name, or something is not a member.
    """
    if isinstance(given, Mapping):
        parts = [_part(value, identifier(name)) for name, value in given.items()]
    elif isinstance(given, str | Part):
        parts = [_part(given, None)]
    else:
        parts = [_part(value, None) for value in given]
    if not parts:
        raise SkillError("there is nothing to compose", expected="at least one member")
    twice = next(iter(_repeated([part.name for part in parts])), None)
    if twice:
        raise SkillError(
            f"two members are called '{twice}'",
            hint="name them, as in compose({'left': …, 'right': …}) or Member(…, name='left')",
        )
    return parts


def identifier(name: str) -> str:
    """A name as formulas write it: ``stop-for-person`` is ``stop_for_person``.

    Raises:
        SkillError: The name cannot stand in a formula.
    """
    found = re.sub(r"[\s-]+", "_", str(name).strip())
    if not _IDENTIFIER.fullmatch(found) or found.startswith("__") or is_reserved(found):
        raise SkillError(
            f"'{name}' cannot be the name of a member",
            expected="letters, digits and underscores, and no operator of LTL such as G or next",
        )
    return found


def _repeated(names: Sequence[str]) -> Iterator[str]:
    return (name for name in names if names.count(name) > 1)


def _part(given: Given, name: str | None) -> Part:
    match given:
        case TransitionSystem():
            if name is None:
                raise SkillError(
                    "a transition system needs a name", hint="compose({'left': system, …})"
                )
            return SystemPart(name, given)
        case Skill() | str() | Path():
            return Member(given, name=name)
        case Mapping():
            return _from_mapping(given, name)
        case (skill, plan):
            return Member(skill, plan, name=name)
        case Part():
            return given if name in (None, given.name) else _renamed(given, str(name))
    raise SkillError(f"{type(given).__name__} is not a member", expected=_FORMS)


def _renamed(part: Part, name: str) -> Part:
    if isinstance(part, Member):
        return Member(part.skill, part.plan, name=name, platform=part.platform)
    rename = getattr(part, "named", None)
    if rename is None:
        raise SkillError(f"the member '{part.name}' cannot be renamed to '{name}'")
    renamed: Part = rename(name)
    return renamed


def _from_mapping(given: Mapping[str, Any], name: str | None) -> Member:
    unknown = sorted(set(given) - {"skill", "plan", "name", "platform"})
    if unknown or "skill" not in given:
        what = f"'{unknown[0]}' is not known" if unknown else "'skill' is missing"
        raise SkillError(
            f"the description of a member is wrong: {what}",
            expected="skill, and perhaps plan, name and platform",
        )
    return Member(
        given["skill"],
        given.get("plan"),
        name=name if name is not None else given.get("name"),
        platform=given.get("platform"),
    )


def _skill(skill: Skill | str | Path) -> Skill:
    if isinstance(skill, Skill):
        return skill
    if not isinstance(skill, str | Path):
        raise SkillError(f"{type(skill).__name__} is not a skill", expected="a skill or its name")
    from vaso.skill_file import load_skill

    return load_skill(skill)


def _plan(plan: Plan | str | Path | None, skill: Skill) -> Plan:
    if plan is None:
        return Plan(source=skill.plan_template)
    if isinstance(plan, Plan):
        return plan
    return Plan.read(plan) if isinstance(plan, Path) else Plan(source=plan)
