"""Changes of a plan's text that keep its line numbers.

An edit is (line, byte column, end line, end byte column, text), with lines counted from 1 as the
``ast`` module does.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from typing import TypeAlias

from vaso.plan.nodes import nodes

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
    """Type aliases become ``pass``; annotations of variables go (the sandbox evaluates them).

    In the body of a class they stay: they are a dataclass's fields, and are not evaluated there.
    """
    classes = [n for n in nodes(tree) if isinstance(n, ast.ClassDef)]
    fields = {id(n) for c in classes for n in c.body if isinstance(n, ast.AnnAssign)}
    for node in nodes(tree):
        if not isinstance(node, (ast.Assign, ast.AnnAssign)) or id(node) in fields:
            continue
        if node.value is None or is_type(node.value):
            yield replace_statement(node, "pass")
        elif isinstance(node, ast.AnnAssign):
            target, note = node.target, node.annotation
            start = (target.end_lineno or 0, target.end_col_offset or 0)
            yield *start, note.end_lineno or 0, note.end_col_offset or 0, ""


def is_type(node: ast.AST) -> bool:
    """True for an expression that can only be a type, such as ``Tuple[float, float]``."""
    if isinstance(node, ast.Subscript):
        base = node.value.attr if isinstance(node.value, ast.Attribute) else None
        base = node.value.id if isinstance(node.value, ast.Name) else base
        return base in _TYPING
    return (
        isinstance(node, ast.BinOp)
        and isinstance(node.op, ast.BitOr)
        and (is_type(node.left) or is_type(node.right))
    )


_ROUND = """
__vaso_round__ = round
def round(number, ndigits=None):
    if isinstance(number, float) and isinstance(ndigits, int) and 0 < ndigits < 20:
        return float(f"{number:.{ndigits}f}")
    return __vaso_round__(number, ndigits)
"""


def round_prelude(tree: ast.AST) -> str:
    """A ``round`` that rounds decimals as CPython does; the sandbox's own rounds scaled values."""
    used = any(isinstance(n, ast.Name) and n.id == "round" for n in nodes(tree))
    return _ROUND if used else ""


def import_edits(tree: ast.AST, own: Callable[[ast.ImportFrom], bool]) -> Iterator[Edit]:
    """Imports of the skill's own functions become ``pass``."""
    for node in nodes(tree):
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
    classes = [n for n in nodes(tree) if isinstance(n, ast.ClassDef)]
    own = {id(statement) for c in classes for statement in c.body}
    for node in nodes(tree):
        target = grown(node)
        if target and isinstance(node, ast.stmt) and id(node) not in own:
            end_line, end = node.end_lineno or node.lineno, node.end_col_offset or 0
            code = f"; __vaso_mark__({target!r}, {target}, {node.lineno})"
            yield end_line, end, end_line, end, code


def grown(node: ast.AST) -> str | None:
    """The variable that a statement may give a longer list; None if it does no such thing."""
    value = getattr(node, "value", None)
    if value is not None and is_type(value):
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
    lines = [f"{FOUND}_list = []"]
    for name in [VALUE, *lists_of(tree)]:
        lines += [
            "try:",
            f"    if isinstance({name}, (list, tuple)): {FOUND}_list.append(({name!r}, {name}))",
            "except NameError: pass",
        ]
    return "\n".join([*lines, f"{FOUND}({FOUND}_list, list({MARKS}.items()))", ""])


def lists_of(tree: ast.Module) -> list[str]:
    """The variables that may hold a list, the one that was set or grown last first."""
    names: list[str] = []
    for node in tree.body:
        for name in _assigned(node):
            names = [name, *(n for n in names if n != name)]
    return names


def _assigned(node: ast.stmt) -> Iterator[str]:
    for inner in ast.walk(node):
        if isinstance(inner, (ast.FunctionDef, ast.ClassDef)):
            return
        name = grown(inner)
        if name:
            yield name
