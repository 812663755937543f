"""Properties, which become methods."""

from __future__ import annotations

import ast
from collections import deque
from collections.abc import Iterator
from datetime import date, datetime, time, timedelta

from vaso.plan.nodes import nodes
from vaso.plan.rewrite import Edit

_DATES = (date, datetime, time, timedelta)
_KNOWN = frozenset(
    name
    for kind in (str, list, dict, set, tuple, int, float, BaseException, deque, *_DATES)
    for name in dir(kind)
) | {"name", "value", "popleft", "elements"}
"""Attributes of objects that are not the plan's own."""

_MARK = "property"
_BY_TEXT = frozenset(
    {
        "getattr", "setattr", "hasattr", "delattr", "vars", "attrgetter", "namedtuple",
        "make_dataclass", _MARK
    }
)  # fmt: skip
"""Functions that make or find attributes by a text."""


def property_edits(source: str, tree: ast.Module) -> Iterator[Edit]:
    """``@property`` goes, and ``robot.done`` becomes ``robot.done()``.

    Only where a name can be nothing but that property, wherever it is read.

    Args:
        source: The plan's text.
        tree: Its syntax tree.
    """
    found = _properties(tree)
    if not found or found.keys() & _ambiguous(tree, found):
        return
    lines = [line.encode() for line in source.split("\n")]
    edits: list[Edit] = []
    for node in nodes(tree):
        if isinstance(node, ast.Attribute) and node.attr in found:
            line, end = node.end_lineno or 0, node.end_col_offset or 0
            if not lines[line - 1][:end].endswith(node.attr.encode()):
                return  # inside a text with values, where older Pythons do not know the place
            edits.append((line, end, line, end, "()"))
    yield from edits
    yield from (unmarked(mark, lines) for mark in found.values())


def unmarked(mark: ast.expr, lines: list[bytes]) -> Edit:
    """A decorator goes, its line stays."""
    start = lines[mark.lineno - 1].rfind(b"@", 0, mark.col_offset)
    return mark.lineno, start, mark.end_lineno or 0, mark.end_col_offset or 0, ""


def _properties(tree: ast.Module) -> dict[str, ast.expr]:
    """The properties by name, with the mark of each."""
    classes = [n for n in nodes(tree) if isinstance(n, ast.ClassDef)]
    methods = [m for c in classes for m in c.body if isinstance(m, ast.FunctionDef)]
    marked = [m for m in methods if [getattr(d, "id", "") for d in m.decorator_list] == [_MARK]]
    return {method.name: method.decorator_list[0] for method in marked}


def _ambiguous(tree: ast.Module, found: dict[str, ast.expr]) -> set[str]:
    """Names of properties that something else in the plan may be called, or be asked for by."""
    marks = {id(mark) for mark in found.values()}
    modules = {"time", "math"}
    for node in nodes(tree):
        if isinstance(node, ast.Import):
            modules |= {alias.asname or alias.name for alias in node.names}
        by_text = {getattr(node, "id", ""), getattr(node, "attr", "")} & _BY_TEXT
        if by_text and id(node) not in marks:
            return set(found)
    taken, defined = set(_KNOWN), set[str]()
    for node in nodes(tree):
        if isinstance(node, ast.ClassDef):
            for own in map(_defined, node.body):
                taken |= own & defined
                defined |= own
        elif isinstance(node, ast.Attribute):
            of_module = isinstance(node.value, ast.Name) and node.value.id in modules
            if of_module or not isinstance(node.ctx, ast.Load):
                taken.add(node.attr)
    return taken


def _defined(statement: ast.stmt) -> set[str]:
    """The names that a statement in a class's body defines."""
    if isinstance(statement, ast.FunctionDef | ast.ClassDef):
        return {statement.name}
    return {n.id for n in ast.walk(statement) if isinstance(n, ast.Name) and _stores(n)}


def _stores(node: ast.Name) -> bool:
    return isinstance(node.ctx, ast.Store)
