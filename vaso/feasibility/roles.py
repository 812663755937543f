"""Which propositions the world decides, and which the robot."""

from __future__ import annotations

import ast
from collections.abc import Callable
from enum import Enum

from vaso.errors import SkillError
from vaso.ltl import propositions, variables
from vaso.platforms import Platform
from vaso.skill import Rule, Skill

__all__ = ["Role", "check_assumption", "role_finder"]


class Role(Enum):
    """Who decides about a proposition."""

    WORLD = "world"
    ROBOT = "robot"
    UNKNOWN = "unknown"


RoleFinder = Callable[[str], Role]


def role_finder(skill: Skill, platform: Platform) -> RoleFinder:
    """Return a function that tells who decides about a proposition.

    The platform says so for its standard propositions. For another name the labelling code does: a
    function that returns a truth value observes, one that returns nothing acts.

    Args:
        skill: The skill whose propositions are asked about.
        platform: Its platform.
    """
    defined = _functions(skill.labelling_code)

    def role(name: str) -> Role:
        known = platform.proposition(name)
        if known is not None:
            return Role.WORLD if known.kind == "observation" else Role.ROBOT
        return defined.get(name, Role.UNKNOWN)

    return role


def check_assumption(rule: Rule, role: RoleFinder) -> None:
    """Check that an assumption speaks about the world only.

    Raises:
        SkillError: It speaks about something that the robot decides.
    """
    for name in sorted(propositions(rule.formula) | variables(rule.formula)):
        if role(name) is Role.ROBOT:
            raise SkillError(
                f"the assumption {rule} speaks about '{name}', which the robot decides",
                expected="a formula over observations, such as G F !people_observed",
                hint="what the robot must do belongs into the contract, as a rule",
            )


def _functions(code: str) -> dict[str, Role]:
    try:
        tree = ast.parse(code)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return {}
    return {n.name: _role(n) for n in tree.body if isinstance(n, ast.FunctionDef)}


def _role(function: ast.FunctionDef) -> Role:
    if function.returns is not None:
        annotation = ast.unparse(function.returns).strip("'\"")
        return {"bool": Role.WORLD, "None": Role.ROBOT}.get(annotation, Role.UNKNOWN)
    returned = [n.value for n in ast.walk(function) if isinstance(n, ast.Return)]
    return Role.WORLD if any(v is not None and not _is_none(v) for v in returned) else Role.ROBOT


def _is_none(value: ast.expr) -> bool:
    return isinstance(value, ast.Constant) and value.value is None
