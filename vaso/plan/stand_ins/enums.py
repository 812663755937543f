"""A plan's enumerations, whose members become objects."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from vaso.errors import UnsupportedPlanError
from vaso.plan.nodes import annotations_in, nodes
from vaso.plan.rewrite import Edit, replace_statement
from vaso.plan.stand_ins.reading import bases_of, says_nothing

MEMBER = "__vaso_member__"
_MEMBER_CLASS = f"""
class {MEMBER}:
    def __init__(self, owner, name, value):
        self.name = name
        self.value = value
        self._owner = owner
    def __str__(self):
        return self._owner + "." + self.name
    def __repr__(self):
        return "<" + str(self) + ": " + repr(self.value) + ">"
"""


def enum_prelude(tree: ast.AST) -> str:
    """What must run before a plan with enumerations."""
    return _MEMBER_CLASS if _enums(tree) else ""


def enum_edits(tree: ast.AST, name: str) -> Iterator[Edit]:
    """The members of plain enumerations become objects; the sandbox knows no inheritance.

    An object has the member's name and value, is equal to itself only, and is true.

    Args:
        tree: The plan.
        name: How messages call it.

    Raises:
        UnsupportedPlanError: The plan uses the enumeration otherwise than for its members.
    """
    enums = _enums(tree)
    _check_members_only(tree, {e.name for e in enums}, name)
    for node in enums:
        base = node.bases[0]
        yield base.lineno, base.col_offset, base.lineno, base.end_col_offset or 0, ""
        for member, text in _members(node, name):
            yield replace_statement(member, text)
    for statement in nodes(tree):
        if isinstance(statement, ast.stmt) and _imports_enum(statement):
            yield replace_statement(statement, "pass")


def _enums(tree: ast.AST) -> list[ast.ClassDef]:
    return [n for n in nodes(tree) if isinstance(n, ast.ClassDef) and is_plain_enum(n)]


def _members(node: ast.ClassDef, name: str) -> Iterator[tuple[ast.stmt, str]]:
    """The members with what they become; one with the value of an earlier one is that one."""
    known: list[tuple[object, str]] = []
    for member in node.body:
        if not isinstance(member, ast.Assign) or not isinstance(member.targets[0], ast.Name):
            continue
        value, own = _member_value(member.value, [v for v, _ in known]), member.targets[0].id
        if value is None:
            raise UnsupportedPlanError(
                f"the value of '{node.name}.{own}' is not a literal",
                source=name,
                line=member.lineno,
            )
        first = next((n for v, n in known if v == value[0]), None)
        known.append((value[0], own))
        text = first or f"{MEMBER}({node.name!r}, {own!r}, {value[0]!r})"
        yield member, f"{own} = {text}"


def _member_value(node: ast.expr, before: list[object]) -> tuple[object] | None:
    if isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) == (
        "auto"
    ):
        return (max((v for v in before if isinstance(v, int)), default=0) + 1,)
    try:
        return (ast.literal_eval(node),)
    except (ValueError, TypeError):
        return None


def _check_members_only(tree: ast.AST, enums: set[str], name: str) -> None:
    """``State.DRIVE`` and annotations; not ``State(1)``, ``for s in State``, ``isinstance``."""
    allowed = {id(n.value) for n in nodes(tree) if isinstance(n, ast.Attribute)}
    allowed |= {id(part) for note in annotations_in(tree) for part in ast.walk(note)}
    for node in nodes(tree):
        if isinstance(node, ast.Name) and node.id in enums and id(node) not in allowed:
            raise UnsupportedPlanError(
                f"the enumeration '{node.id}' is used as a whole",
                source=name,
                line=node.lineno,
                expected=f"its members, such as {node.id}.SOMETHING",
            )


def is_plain_enum(node: ast.ClassDef) -> bool:
    """True for ``class State(Enum)`` whose body only assigns members."""
    if bases_of(node) != ["Enum"] or node.keywords or node.decorator_list:
        return False
    return all(
        (isinstance(n, ast.Assign) and len(n.targets) == 1 and isinstance(n.targets[0], ast.Name))
        or says_nothing(n)
        for n in node.body
    )


def _imports_enum(node: ast.AST) -> bool:
    if isinstance(node, ast.ImportFrom):
        return node.module == "enum" and {a.name for a in node.names} <= {"Enum", "auto"}
    return isinstance(node, ast.Import) and [a.name for a in node.names] == ["enum"]
