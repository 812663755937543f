"""A planner without a language model: the plan template with the task's quantities in it."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from vaso.modules.leftover import left_out
from vaso.modules.quantities import Quantities, read_quantities
from vaso.plan.model import Plan
from vaso.skill import Skill

OBJECT = "TARGET"
KNOWN = (set(Quantities.__dataclass_fields__) - {"target"}) | {OBJECT}
"""The constants of templates that a prompt can give a value."""


@dataclass(frozen=True)
class Filling:
    """A template that was filled in.

    Attributes:
        plan: The plan.
        filled: The constants that the task gave a value, with it.
        kept: The constants that the task could have given a value but does not speak of, with the
            template's own value.
        unused: The parts of the task that could not be used, as they stand in it.
    """

    plan: Plan
    filled: Mapping[str, Any] = field(default_factory=dict)
    kept: Mapping[str, Any] = field(default_factory=dict)
    unused: tuple[str, ...] = ()


class SymbolicPlanner:
    """Instantiates a skill's plan template; a planner that needs no model and no network.

    It replaces the literal values of the template's top-level constants whose names it knows
    (``distance_m``, ``turn_deg``, ``legs``, ``side_m``, ``altitude_m``, ``speed_mps``, ``pause_s``,
    ``standoff_m``, ``clockwise``, ``TARGET``) by the quantities in the prompt, and leaves
    everything else, comments included, as it is.
    """

    def __init__(self, *, places: Mapping[str, float] | None = None) -> None:
        """Configure.

        Args:
            places: Metres ahead of the robot to places that tasks may send it to, by name.
        """
        self.places = dict(places or {})

    def __call__(self, skill: Skill, task: Any) -> Plan:
        """Write the plan for a task.

        Args:
            skill: The skill whose template is instantiated.
            task: A prompt, or an object with an attribute ``prompt``.
        """
        return self.fill(skill, task).plan

    def fill(self, skill: Skill, task: Any) -> Filling:
        """Write the plan for a task, and say what of the task went into it."""
        prompt = str(getattr(task, "prompt", task))
        values = read_quantities(prompt, self.places).constants()
        own = literals_of(skill.plan_template)
        source = instantiate(skill.plan_template, values)
        filled = {name: value for name, value in values.items() if name in own}
        if OBJECT in values and _needs_object(skill):
            source = f"{OBJECT} = {_quote(values[OBJECT])}\n{source}"
            filled[OBJECT] = values[OBJECT]
        return Filling(
            plan=Plan(source=source, task=prompt),
            filled=filled,
            kept={name: own[name] for name in own if name in KNOWN and name not in filled},
            unused=left_out(prompt, skill, filled, self.places),
        )


class Literal(NamedTuple):
    """A top-level constant of a text: its name, and its value's node with the place in the text."""

    name: str
    node: ast.expr


def instantiate(template: str, values: dict[str, Any]) -> str:
    """Replace the values of a template's top-level constants.

    Args:
        template: Python source. One that does not parse comes back unchanged.
        values: New values by constant name; names that the template does not have are ignored.

    Returns:
        The source with only those literals changed. A whole number stays without a decimal
        point where the template wrote one without.
    """
    try:
        tree = ast.parse(template)
    except (SyntaxError, ValueError):
        return template
    lines = template.replace("\r\n", "\n").encode().split(b"\n")
    found = [lit for lit in _literals(tree) if lit.name in values]
    for literal in sorted(found, key=_place, reverse=True):
        _replace(lines, literal.node, _text(values[literal.name], literal.node))
    return b"\n".join(lines).decode()


def constants_of(code: str) -> set[str]:
    """Names of the top-level constants of a text whose values are literals."""
    return set(literals_of(code))


def literals_of(code: str) -> dict[str, Any]:
    """The top-level constants of a text whose values are literals, with their values."""
    try:
        tree = ast.parse(code)
    except (SyntaxError, ValueError):
        return {}
    return {literal.name: ast.literal_eval(literal.node) for literal in _literals(tree)}


def _place(literal: Literal) -> tuple[int, int]:
    return literal.node.lineno, literal.node.col_offset


def _literals(tree: ast.Module) -> Iterator[Literal]:
    for statement in tree.body:
        if isinstance(statement, ast.Assign) and len(statement.targets) == 1:
            yield from _pairs(statement.targets[0], statement.value)
        elif isinstance(statement, ast.AnnAssign) and statement.value is not None:
            yield from _pairs(statement.target, statement.value)


def _pairs(target: ast.expr, value: ast.expr) -> Iterator[Literal]:
    if isinstance(target, ast.Name) and _is_literal(value):
        yield Literal(target.id, value)
    elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        for one, other in zip(target.elts, value.elts, strict=False):
            yield from _pairs(one, other)


def _is_literal(node: ast.expr) -> bool:
    try:
        ast.literal_eval(node)
    except ValueError:
        return False
    return True


def _replace(lines: list[bytes], node: ast.expr, text: str) -> None:
    assert node.end_lineno is not None
    first, last = node.lineno - 1, node.end_lineno - 1
    after = lines[last][node.end_col_offset :]
    lines[first] = lines[first][: node.col_offset] + text.encode() + after
    del lines[first + 1 : last + 1]


def _text(value: Any, node: ast.expr) -> str:
    if isinstance(value, str):
        return _quote(value)
    whole = isinstance(value, float) and value.is_integer()
    if whole and type(ast.literal_eval(node)) is int:
        return str(int(value))
    return repr(value)


def _quote(text: str) -> str:
    return f'"{text}"'


def _needs_object(skill: Skill) -> bool:
    own, template = constants_of(skill.labelling_code), constants_of(skill.plan_template)
    return OBJECT in own - template
