"""Propositions whose value depends on what the labelling code remembers.

Each skill on a robot has labelling code of its own, which does not hear of the commands that
another skill's plan sends. A function that reads variables which the code changes, such as the
speed that was commanded last, may then say something that is no longer so.
"""

from __future__ import annotations

import ast

from vaso.errors import PlanError
from vaso.plan.source import parse_python

__all__ = ["remembering"]

_OPAQUE = frozenset(["globals", "locals", "vars", "exec", "eval", "getattr", "setattr"])


def remembering(code: str) -> frozenset[str]:
    """Functions of some labelling code whose answer may depend on earlier calls.

    A function is named here unless it is plain that it is not one: it may read constants that no
    function changes, sensors, its arguments, and functions of which the same is true.
    """
    try:
        tree = parse_python(code, "labelling code")
    except PlanError:
        return frozenset()
    functions = {n.name: n for n in tree.body if isinstance(n, ast.FunctionDef)}
    state = _variables(tree) | _OPAQUE
    found = {name for name, node in functions.items() if _is_opaque(node, state, functions)}
    while more := {n for n, node in functions.items() if _names(node) & found} - found:
        found |= more
    return frozenset(found)


def _names(node: ast.AST) -> set[str]:
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}


def _variables(tree: ast.Module) -> set[str]:
    """Module-level names that may change, or whose value may."""
    changed = {n for node in ast.walk(tree) if isinstance(node, ast.Global) for n in node.names}
    for node in tree.body:
        match node:
            case ast.Import() | ast.ImportFrom() | ast.FunctionDef():
                continue
            case ast.Assign(targets=targets, value=value) if _is_constant(value):
                once = {t.id for t in targets if isinstance(t, ast.Name)}
                changed |= once & _assigned_again(tree, node)
            case _:
                changed |= {
                    n.id
                    for n in ast.walk(node)
                    if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
                }
                changed |= {n.name for n in ast.walk(node) if isinstance(n, ast.ClassDef)}
    return changed


def _assigned_again(tree: ast.Module, first: ast.stmt) -> set[str]:
    others = [node for node in tree.body if node is not first]
    return {
        n.id
        for node in others
        if not isinstance(node, ast.FunctionDef)
        for n in ast.walk(node)
        if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
    }


def _is_constant(value: ast.expr) -> bool:
    """Numbers, texts, and tuples and arithmetic of them: nothing that can be changed in place."""
    match value:
        case ast.Constant() | ast.Name() | ast.Attribute(value=ast.Name()):
            return True
        case ast.UnaryOp(operand=operand):
            return _is_constant(operand)
        case ast.BinOp(left=left, right=right):
            return _is_constant(left) and _is_constant(right)
        case ast.Tuple(elts=parts):
            return all(map(_is_constant, parts))
    return False


def _is_opaque(
    node: ast.FunctionDef, state: set[str], functions: dict[str, ast.FunctionDef]
) -> bool:
    defaults = [*node.args.defaults, *(d for d in node.args.kw_defaults if d is not None)]
    if node.decorator_list or not all(map(_is_constant, defaults)):
        return True
    if _names(node) & state:
        return True
    owners = (n.value for n in ast.walk(node) if isinstance(n, ast.Attribute))
    return any(isinstance(owner, ast.Name) and owner.id in functions for owner in owners)
