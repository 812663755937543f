"""The nodes of a program's syntax tree, walked once."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from itertools import chain, islice
from weakref import WeakKeyDictionary

__all__ = ["annotations_in", "nodes"]

_below: WeakKeyDictionary[ast.Module, tuple[ast.AST, ...]] = WeakKeyDictionary()
"""The nodes below a program's, without itself, so that it can be let go."""


def nodes(tree: ast.AST) -> Iterator[ast.AST]:
    """All nodes below and including one, in the order of ``ast.walk``.

    Many checks look at all nodes of a program, one after the other, and none changes the tree; the
    walk takes longer than the looks.
    """
    if not isinstance(tree, ast.Module):
        return ast.walk(tree)
    below = _below.get(tree)
    if below is None:
        below = _below[tree] = tuple(islice(ast.walk(tree), 1, None))
    return chain((tree,), below)


def annotations_in(tree: ast.AST) -> Iterator[ast.expr]:
    """The annotations below a node, which are looked at when it is defined, or never."""
    for node in nodes(tree):
        for field in ("annotation", "returns"):
            if isinstance(note := getattr(node, field, None), ast.expr):
                yield note
