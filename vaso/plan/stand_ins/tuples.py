"""Tuples with named fields, written as classes."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from vaso.plan.nodes import nodes
from vaso.plan.rewrite import Edit, replace_statement
from vaso.plan.stand_ins.reading import bases_of, says_nothing

_NAMED_TUPLE = "__vaso_namedtuple__"


def tuple_prelude(tree: ast.Module) -> str:
    """What must run before a plan that has named tuples."""
    return f"from collections import namedtuple as {_NAMED_TUPLE}\n" if named_tuples(tree) else ""


def tuple_edits(tree: ast.Module) -> Iterator[Edit]:
    """``class Leg(NamedTuple)`` becomes a call of ``namedtuple``."""
    for node in named_tuples(tree):
        yield replace_statement(node, _named_tuple(node))


def named_tuples(tree: ast.Module) -> list[ast.ClassDef]:
    """The classes that derive from ``NamedTuple`` and only declare fields."""
    found = [n for n in nodes(tree) if isinstance(n, ast.ClassDef) and _is_named_tuple(n)]
    return found if all(map(_only_declares, found)) else []


def _is_named_tuple(node: ast.ClassDef) -> bool:
    return bases_of(node) == ["NamedTuple"] and not node.keywords and not node.decorator_list


def _only_declares(node: ast.ClassDef) -> bool:
    return all(
        (isinstance(n, ast.AnnAssign) and isinstance(n.target, ast.Name)) or says_nothing(n)
        for n in node.body
    )


def _named_tuple(node: ast.ClassDef) -> str:
    fields = [n for n in node.body if isinstance(n, ast.AnnAssign)]
    names = ", ".join(repr(n.target.id) for n in fields if isinstance(n.target, ast.Name))
    defaults = "".join(f"{ast.unparse(n.value)}, " for n in fields if n.value)
    return f"{node.name} = {_NAMED_TUPLE}({node.name!r}, [{names}], defaults=({defaults}))"
