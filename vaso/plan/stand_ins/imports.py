"""Imports of names that only annotations use, and ``functools.wraps``."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from vaso.plan.nodes import annotations_in, nodes
from vaso.plan.rewrite import Edit, is_type, replace_statement
from vaso.plan.stand_ins.tuples import named_tuples

_TYPES = frozenset({"typing", "typing_extensions", "collections.abc"})
_WRAPS = "wraps"
_WRAPPER = f"""
def {_WRAPS}(function, *rest, **named):
    return lambda wrapper: wrapper
"""
"""The stand-in; what a function is called matters to no plan that does not ask."""


def import_prelude(tree: ast.Module) -> str:
    """What must run before a plan that wraps functions."""
    return _WRAPPER if _wraps(tree) else ""


def name_edits(tree: ast.Module) -> Iterator[Edit]:
    """Types that nothing but annotations names are not imported; nor is ``wraps``.

    Args:
        tree: The plan.
    """
    used = _used(tree) - ({"NamedTuple"} if named_tuples(tree) else set())
    wraps = _wraps(tree)
    for node in nodes(tree):
        if not isinstance(node, ast.ImportFrom) or node.level:
            continue
        gone = {a.name for a in node.names if (a.asname or a.name) not in used}
        gone = gone - {"*"} if node.module in _TYPES else set()
        if wraps and node.module == "functools":
            gone = {_WRAPS}
        kept = [a for a in node.names if a.name not in gone]
        if gone and len(kept) < len(node.names):
            names = ", ".join(map(ast.unparse, kept))
            yield replace_statement(node, f"from {node.module} import {names}" if kept else "pass")


def _used(tree: ast.Module) -> set[str]:
    """Names that are read where the program runs: not in annotations, nor in names of types."""
    given = (n.value for n in nodes(tree) if isinstance(n, ast.Assign | ast.AnnAssign))
    types = [*annotations_in(tree), *(value for value in given if value and is_type(value))]
    notes = {id(part) for note in types for part in ast.walk(note)}
    return {n.id for n in nodes(tree) if isinstance(n, ast.Name) and id(n) not in notes}


def _wraps(tree: ast.Module) -> bool:
    """True for a plan that imports ``wraps`` by name, and never asks what a function is called."""
    imported = any(
        isinstance(n, ast.ImportFrom)
        and n.module == "functools"
        and any(a.name == _WRAPS and a.asname is None for a in n.names)
        for n in nodes(tree)
    )
    asked = {n.attr for n in nodes(tree) if isinstance(n, ast.Attribute)}
    return imported and not asked & {"__name__", "__doc__", "__wrapped__", "__qualname__"}
