"""``del rooms[0]``, which the sandbox does not know, becomes ``rooms.pop(0)``."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from vaso.plan.nodes import nodes
from vaso.plan.rewrite import Edit

_OTHERWISE = frozenset({"deque", "Counter", "__delitem__"})
"""Names in plans with objects that delete otherwise than they pop."""


def deletion_edits(source: str, tree: ast.Module) -> Iterator[Edit]:
    """Items of lists and dictionaries are popped instead of deleted.

    Args:
        source: The plan's text.
        tree: Its syntax tree.
    """
    if any(_mentions(node) & _OTHERWISE for node in nodes(tree)):
        return
    lines = [line.encode() for line in source.split("\n")]
    for node in nodes(tree):
        target = node.targets[0] if isinstance(node, ast.Delete) else None
        if (
            isinstance(node, ast.Delete)
            and isinstance(target, ast.Subscript)
            and len(node.targets) == 1
            and not isinstance(target.slice, ast.Slice | ast.Tuple)
        ):
            yield from _popped(node, target, lines)


def _popped(node: ast.Delete, target: ast.Subscript, lines: list[bytes]) -> Iterator[Edit]:
    """Only the word and the brackets change, so that other edits fit in between."""
    line, column = target.value.end_lineno or 0, target.value.end_col_offset or 0
    end_line, end = target.end_lineno or 0, target.end_col_offset or 0
    start = target.value.lineno, target.value.col_offset
    bracket = lines[line - 1].find(b"[", column)
    same = (node.lineno, node.end_lineno, node.end_col_offset) == (start[0], end_line, end)
    if same and bracket >= 0 and lines[line - 1][column:bracket].strip() == b"":
        yield node.lineno, node.col_offset, *start, ""
        yield line, bracket, line, bracket + 1, ".pop("
        yield end_line, end - 1, end_line, end, ")"


def _mentions(node: ast.AST) -> set[str]:
    if isinstance(node, ast.ImportFrom):
        return {alias.name for alias in node.names}
    return {getattr(node, "id", ""), getattr(node, "attr", ""), getattr(node, "name", "")}
