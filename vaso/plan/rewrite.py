"""Changes of a plan's text that keep its line numbers.

An edit is (line, byte column, end line, end byte column, text), with lines counted from 1 as the
``ast`` module does.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from typing import TypeAlias

Edit: TypeAlias = tuple[int, int, int, int, str]

MARKS = "__vaso_marks__"
FOUND = "__vaso_trajectory__"
VALUE = "__vaso_value__"
MARKER = f"""
{VALUE} = None
{MARKS} = {{}}
def __vaso_mark__(name, value, line):
    if isinstance(value, list):
        {MARKS}[(name, len(value))] = line
"""
_TYPING = frozenset(
    {
        "List", "Tuple", "Dict", "Set", "Optional", "Union", "Callable", "Sequence",
        "Iterable", "Iterator", "Literal", "Mapping", "Any", "Type", "list", "tuple", "dict",
        "set", "frozenset", "type"
    }
)  # fmt: skip


def alias_edits(tree: ast.AST) -> Iterator[Edit]:
    """Type aliases become ``pass``; annotations of variables go (the sandbox evaluates them)."""
    for node in ast.walk(tree):
        if not isinstance(node, (ast.Assign, ast.AnnAssign)):
            continue
        if node.value is None or _is_type(node.value):
            yield replace_statement(node, "pass")
        elif isinstance(node, ast.AnnAssign):
            target, note = node.target, node.annotation
            start = (target.end_lineno or 0, target.end_col_offset or 0)
            yield *start, note.end_lineno or 0, note.end_col_offset or 0, ""


def _is_type(node: ast.AST) -> bool:
    if isinstance(node, ast.Subscript):
        base = node.value.attr if isinstance(node.value, ast.Attribute) else None
        base = node.value.id if isinstance(node.value, ast.Name) else base
        return base in _TYPING
    return (
        isinstance(node, ast.BinOp)
        and isinstance(node.op, ast.BitOr)
        and (_is_type(node.left) or _is_type(node.right))
    )


def enum_edits(tree: ast.AST) -> Iterator[Edit]:
    """Plain enumerations become classes of distinct constants; the sandbox knows no inheritance.

    A member becomes ``("State", "DRIVE")``: truthy, equal only to itself, like a member of an
    ``Enum``. Its ``name`` and ``value`` are not there, so a plan that uses them is not supported.
    """
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef) and is_plain_enum(node):
            base = node.bases[0]
            yield base.lineno, base.col_offset, base.lineno, base.end_col_offset or 0, ""
            for member in node.body:
                if isinstance(member, ast.Assign) and isinstance(member.targets[0], ast.Name):
                    text = f'{member.targets[0].id} = ("{node.name}", "{member.targets[0].id}")'
                    yield replace_statement(member, text)
        elif _imports_enum(node):
            assert isinstance(node, ast.stmt)
            yield replace_statement(node, "pass")


def is_plain_enum(node: ast.ClassDef) -> bool:
    """True for ``class State(Enum)`` whose body only assigns members."""
    bases = [b.attr if isinstance(b, ast.Attribute) else getattr(b, "id", "") for b in node.bases]
    if bases != ["Enum"] or node.keywords or node.decorator_list:
        return False
    return all(
        (isinstance(n, ast.Assign) and len(n.targets) == 1 and isinstance(n.targets[0], ast.Name))
        or isinstance(n, ast.Pass)
        or (isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant))
        for n in node.body
    )


def _imports_enum(node: ast.AST) -> bool:
    if isinstance(node, ast.ImportFrom):
        return node.module == "enum" and {a.name for a in node.names} <= {"Enum", "auto"}
    return isinstance(node, ast.Import) and [a.name for a in node.names] == ["enum"]


def import_edits(tree: ast.AST, own: Callable[[ast.ImportFrom], bool]) -> Iterator[Edit]:
    """Imports of the skill's own functions become ``pass``."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and own(node):
            yield replace_statement(node, "pass")


def replace_statement(node: ast.stmt, text: str) -> Edit:
    """Replace a statement, keeping the number of lines (a bracketed remainder becomes blank)."""
    return node.lineno, node.col_offset, node.end_lineno or 0, node.end_col_offset or 0, text


def apply_edits(source: str, edits: Sequence[Edit]) -> str:
    """Apply edits given as (line, byte column, end line, end byte column, text), last one first."""
    lines = [line.encode() for line in source.split("\n")]
    for line, column, end_line, end_column, text in sorted(edits, reverse=True):
        head, tail = lines[line - 1][:column], lines[end_line - 1][end_column:]
        lines[line - 1] = head + text.encode() + tail
        lines[line:end_line] = [b""] * (end_line - line)
    return b"\n".join(lines).decode()


def mark_edits(tree: ast.AST) -> Iterator[Edit]:
    """Record after each statement that grows a list how long it is, so elements have lines."""
    for node in ast.walk(tree):
        target = grown(node)
        if target and isinstance(node, ast.stmt):
            end_line, end = node.end_lineno or node.lineno, node.end_col_offset or 0
            code = f"; __vaso_mark__({target!r}, {target}, {node.lineno})"
            yield end_line, end, end_line, end, code


def grown(node: ast.AST) -> str | None:
    """The variable that a statement may give a longer list; None if it does no such thing."""
    value = getattr(node, "value", None)
    if value is not None and _is_type(value):
        return None
    if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
        return node.target.id
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value:
        return node.target.id
    if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
        return node.targets[0].id if len(node.targets) == 1 else None
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        function = node.value.func
        if isinstance(function, ast.Attribute) and function.attr in ("append", "extend", "insert"):
            return function.value.id if isinstance(function.value, ast.Name) else None
    return None


def last_value_edits(tree: ast.Module, tail: str) -> Iterator[Edit]:
    """Keep the value of a last line that is an expression, as a notebook would show it."""
    last = tree.body[-1] if tree.body else None
    if isinstance(last, ast.Expr) and not tail:
        yield last.lineno, last.col_offset, last.lineno, last.col_offset, f"{VALUE} = "


def collect_call(tree: ast.Module) -> str:
    """Hand every list that the plan may mean as its trajectory to the host, likeliest first."""
    names: list[str] = []
    for node in tree.body:
        for name in _assigned(node):
            names = [name, *(n for n in names if n != name)]
    lines = [f"{FOUND}_list = []"]
    for name in [VALUE, *names]:
        lines += [
            "try:",
            f"    if isinstance({name}, (list, tuple)): {FOUND}_list.append(({name!r}, {name}))",
            "except NameError: pass",
        ]
    return "\n".join([*lines, f"{FOUND}({FOUND}_list, list({MARKS}.items()))", ""])


def _assigned(node: ast.stmt) -> Iterator[str]:
    for inner in ast.walk(node):
        if isinstance(inner, (ast.FunctionDef, ast.ClassDef)):
            return
        name = grown(inner)
        if name:
            yield name
