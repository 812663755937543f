"""Static methods and class methods, which become methods with one more parameter."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass

from vaso.plan.nodes import nodes
from vaso.plan.rewrite import Edit
from vaso.plan.stand_ins.properties import unmarked

_UNUSED = "__vaso_unused__"


@dataclass(frozen=True, slots=True)
class _Method:
    """A method that is marked as static, or as the class's own."""

    owner: str
    node: ast.FunctionDef
    mark: ast.expr
    is_static: bool


def method_edits(source: str, tree: ast.Module) -> Iterator[Edit]:
    """``Robot.near(x)`` becomes ``Robot.near(None, x)``, and ``near`` takes a further parameter.

    A class method is handed its class in the same way. Nothing is changed where one of them is used
    otherwise than called on an object, or on its class by name.

    Args:
        source: The plan's text.
        tree: Its syntax tree.
    """
    methods = list(_methods(tree))
    uses = {m.node.name: list(_uses(m, tree)) for m in methods}
    if len(uses) < len(methods) or not all(
        _is_plain(m, use) for m in methods for use in uses[m.node.name]
    ):
        return
    lines = [line.encode() for line in source.split("\n")]
    for method in methods:
        yield unmarked(method.mark, lines)
        if method.is_static:
            name = method.node.col_offset + len("def ")
            line = method.node.lineno
            opening = lines[line - 1].index(b"(", name)
            yield _inserted(line, opening + 1, _UNUSED, bool(_parameters(method.node)))
        for function, call in uses[method.node.name]:
            if call is not None and isinstance(function.value, ast.Name):
                first = _first_argument(method, function.value.id)
                if first:
                    at = function.end_lineno or 0, function.end_col_offset or 0
                    opening = lines[at[0] - 1].index(b"(", at[1])
                    yield _inserted(at[0], opening + 1, first, bool(call.args or call.keywords))


def _methods(tree: ast.Module) -> Iterator[_Method]:
    for owner in nodes(tree):
        for node in owner.body if isinstance(owner, ast.ClassDef) else []:
            marks = node.decorator_list if isinstance(node, ast.FunctionDef) else []
            kinds = [getattr(mark, "id", "") for mark in marks]
            if isinstance(node, ast.FunctionDef) and kinds in (["staticmethod"], ["classmethod"]):
                assert isinstance(owner, ast.ClassDef)
                yield _Method(owner.name, node, marks[0], kinds == ["staticmethod"])


_Use = tuple[ast.Attribute, ast.Call | None]


def _uses(method: _Method, tree: ast.Module) -> Iterator[_Use]:
    """Where an attribute with the method's name is read, and the call that it is the callee of."""
    calls = {id(n.func): n for n in nodes(tree) if isinstance(n, ast.Call)}
    for node in nodes(tree):
        if isinstance(node, ast.Attribute) and node.attr == method.node.name:
            yield node, calls.get(id(node))


def _is_plain(method: _Method, use: _Use) -> bool:
    """True for a call on the class by name, and for a static method on any other variable."""
    function, call = use
    if call is None or not isinstance(function.ctx, ast.Load):
        return False
    if not isinstance(function.value, ast.Name):
        own = isinstance(function.value, ast.Attribute) and function.value.attr != "__class__"
        return method.is_static and own
    if method.is_static:
        return function.value.id != "cls"
    return function.value.id in (method.owner, "cls")


def _first_argument(method: _Method, receiver: str) -> str:
    """What a call must hand over that the method would be given by itself."""
    if not method.is_static:
        return receiver
    return "None" if receiver == method.owner else ""


def _inserted(line: int, column: int, text: str, follows: bool) -> Edit:
    return line, column, line, column, f"{text}, " if follows else text


def _parameters(node: ast.FunctionDef) -> bool:
    rest = node.args
    return bool(rest.posonlyargs or rest.args or rest.vararg or rest.kwonlyargs or rest.kwarg)
