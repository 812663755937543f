"""A plan's own exceptions, which become exceptions that the sandbox knows."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from vaso.plan.nodes import nodes
from vaso.plan.rewrite import Edit, replace_statement
from vaso.plan.stand_ins.reading import says_nothing

_BASE = "OSError"
_KINDS = (
    "FileNotFoundError", "PermissionError", "FileExistsError", "IsADirectoryError",
    "NotADirectoryError"
)  # fmt: skip
"""Exceptions that stand for a plan's own ones: nothing in a plan raises them otherwise, and none of
them is another one. All of them are an ``OSError``."""

_TAKEN = frozenset({_BASE, *_KINDS, "IOError", "EnvironmentError", "TimeoutError"})


def exception_edits(tree: ast.AST) -> Iterator[Edit]:
    """``class Abort(Exception): pass`` becomes another name of an exception that the sandbox knows.

    Also several of them, or one with some that derive from it. Not for a plan that speaks of the
    exceptions that stand in, makes its own with more than a message, or asks what kind one is.
    """
    own = _own(tree)
    names = {n.id for n in nodes(tree) if isinstance(n, ast.Name)}
    if not own or names & _TAKEN or any(_with_arguments(tree, n.name) for n in own):
        return
    if any(map(_asks_for_kind, nodes(tree))):
        return
    for node, stand_in in zip(own, _stand_ins(own), strict=False):
        yield replace_statement(node, f"{node.name} = {stand_in}")


def _own(tree: ast.AST) -> list[ast.ClassDef]:
    """The plan's exceptions that derive from ``Exception``, and those that derive from them."""
    plain = [n for n in nodes(tree) if isinstance(n, ast.ClassDef) and _is_plain(n)]
    roots = {n.name for n in plain if _base(n) == "Exception"}
    return [n for n in plain if _base(n) in {"Exception", *roots}]


def _stand_ins(own: Sequence[ast.ClassDef]) -> list[str]:
    """What stands for each class; nothing where that would mean something else."""
    names = [n.name for n in own]
    bases = {_base(n) for n in own}
    if len(set(names)) < len(names) or len(own) > len(_KINDS):
        return []
    if bases == {"Exception"}:
        return [_BASE] if len(own) == 1 else list(_KINDS)
    alone = sum(_base(n) == "Exception" for n in own) == 1
    return [_BASE, *_KINDS] if alone else []


def _asks_for_kind(node: ast.AST) -> bool:
    """True where a plan may see what an exception is called, or what kind it is exactly."""
    called = node.func.id if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else ""
    asked = node.attr if isinstance(node, ast.Attribute) else ""
    shown = isinstance(node, ast.FormattedValue) and node.conversion == ord("r")
    return called in ("type", "repr") or asked in ("__class__", "__name__", "args") or shown


def _is_plain(node: ast.ClassDef) -> bool:
    """True for a class without a body that may be an exception."""
    empty = all(map(says_nothing, node.body))
    return bool(_base(node)) and empty and not node.keywords and not node.decorator_list


def _base(node: ast.ClassDef) -> str:
    """The name of its only base; empty if there is none, or several."""
    return getattr(node.bases[0], "id", "") if len(node.bases) == 1 else ""


def _with_arguments(tree: ast.AST, name: str) -> bool:
    """True if the exception is made with more than a message, which OSError reads otherwise."""
    calls = [n for n in nodes(tree) if isinstance(n, ast.Call)]
    return any(getattr(c.func, "id", "") == name and len(c.args) > 1 for c in calls)
