"""The words that a change may use: actions, observations, numbers."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass

from vaso.errors import FormulaError
from vaso.feasibility.roles import Role, role_finder
from vaso.ltl import Formula, parse, propositions
from vaso.ltl.syntax import Number, Term
from vaso.ltl.traverse import comparisons, fold_term
from vaso.platforms import Platform
from vaso.skill import Skill

__all__ = ["Vocabulary"]


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """What plans of a skill are made of.

    Attributes:
        actions: Calls without arguments that command the robot; the one that rests first.
        observations: Calls without arguments that sense.
        limits: Numbers that the violated formulas compare with.
        still: For plans that are trajectories, the set-point that stays in place, as text.
        period: Control period in seconds.
    """

    actions: tuple[str, ...] = ()
    observations: tuple[str, ...] = ()
    limits: tuple[float, ...] = ()
    still: str | None = None
    period: float = 1.0

    @classmethod
    def of(
        cls, source: ast.Module, skill: Skill, platform: Platform, violated: Sequence[str] = ()
    ) -> Vocabulary:
        """Gather the words from platform, labelling code, rules and the plan itself.

        Args:
            source: The plan's syntax tree.
            skill: The skill.
            platform: Its platform.
            violated: The violated formulas; what they mention comes first.
        """
        formulas = [f for f in map(_parsed, violated) if f is not None]
        rules = [r.formula for r in (*skill.rules, *skill.assumptions)]
        first = {n for f in formulas for n in propositions(f)}
        called = _called(source)
        named = first | called | {n for f in rules for n in propositions(f)}
        role, usable = role_finder(skill, platform), _callable(skill, platform)
        resting = {n for n, value in _at_rest(platform).items() if value is True}
        actions = [n for n in usable if role(n) is Role.ROBOT and n in first | called | resting]
        seen = [n for n in usable if role(n) is Role.WORLD and n in named]
        return cls(
            actions=tuple(sorted(actions, key=lambda n: (n not in resting, n not in first))),
            observations=tuple(sorted(seen, key=lambda n: n not in first)),
            limits=tuple(dict.fromkeys(n for f in formulas for n in _numbers(f))),
            still=_still(platform),
            period=platform.dt,
        )


def _parsed(text: str) -> Formula | None:
    try:
        return parse(text)
    except FormulaError:
        return None


def _called(tree: ast.Module) -> set[str]:
    return {
        n.func.id
        for n in ast.walk(tree)
        if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
    }


def _callable(skill: Skill, platform: Platform) -> list[str]:
    """Names that a plan can call without arguments, in the order of their definition."""
    if not skill.labelling_code:
        return [p.name for p in platform.propositions if p.kind != "numeric"]
    try:
        tree = ast.parse(skill.labelling_code)
    except (SyntaxError, ValueError):
        return []
    functions = [n for n in tree.body if isinstance(n, ast.FunctionDef)]
    return [f.name for f in functions if not f.args.args and not f.args.kwonlyargs]


def _at_rest(platform: Platform) -> dict[str, bool | float]:
    return dict(platform.dynamics.truth(platform.dynamics.initial()))


def _numbers(formula: Formula) -> list[float]:
    found: list[float] = []

    def note(term: Term, _: tuple[None, ...]) -> None:
        if isinstance(term, Number):
            found.append(term.value)

    for comparison in sorted(comparisons(formula), key=str):
        fold_term(comparison.left, note)
        fold_term(comparison.right, note)
    return found


def _still(platform: Platform) -> str | None:
    command = platform.command(platform.trajectory) if platform.trajectory else None
    if command is None:
        return None
    return repr(platform.rest[command.parameters[0].name])
