"""Simple classes: fields, plain methods, nothing inherited, nothing computed."""

from __future__ import annotations

import ast
from typing import Any

from vaso.labels.symbolic.values import Class, Function, NotUnderstoodError, Poison, Value

__all__ = ["class_of"]

_FREE = frozenset({"staticmethod", "classmethod"})


def class_of(node: ast.ClassDef, names: Any) -> Class:
    """A class from its definition.

    Args:
        node: The definition.
        names: Finds global names for its methods.

    Raises:
        NotUnderstoodError: It is not that simple.
    """
    if node.keywords or any(ast.unparse(base) != "object" for base in node.bases):
        raise NotUnderstoodError("a class with a base")
    decorators = {_name(d) for d in node.decorator_list}
    if decorators - {"dataclass"}:
        raise NotUnderstoodError("a decorated class")
    fields: dict[str, Value] = {}
    methods: dict[str, Function] = {}
    static: set[str] = set()
    for part in node.body:
        if isinstance(part, ast.AnnAssign) and isinstance(part.target, ast.Name) and decorators:
            fields[part.target.id] = _default(part.value)
        elif isinstance(part, ast.FunctionDef):
            free = {_name(d) for d in part.decorator_list}
            if free - _FREE:
                raise NotUnderstoodError("a decorated method")
            static |= {part.name} if free else set()
            methods[part.name] = Function(part, {}, names)
        elif not isinstance(part, ast.Pass) and not _is_text(part):
            raise NotUnderstoodError("a class with variables")
    return Class(node.name, fields, methods, frozenset(static), bool(decorators))


def _name(decorator: ast.expr) -> str:
    called = decorator.func if isinstance(decorator, ast.Call) else decorator
    return ast.unparse(called).rpartition(".")[2]


def _default(node: ast.expr | None) -> Value:
    if node is None:
        return Poison("a field without a value")
    try:
        return ast.literal_eval(node)
    except ValueError as error:
        raise NotUnderstoodError("a field with a computed default") from error


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
