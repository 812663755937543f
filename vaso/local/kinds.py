"""What kind of value an expression of a plan has, as far as a grammar must know it."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping
from functools import reduce
from typing import Any, TypeAlias

Kind: TypeAlias = Any
"""``int``, ``float``, ``bool`` or ``str`` as a text; ``("list", kind)``; ``("tuple", kind, …)``."""
Kinds: TypeAlias = Mapping[str, Kind]

NUMBERS = ("int", "float")
_MATH = {
    **dict.fromkeys(("ceil", "floor", "trunc"), "int"),
    **dict.fromkeys(("radians", "degrees", "sqrt", "sin", "cos", "tan", "fabs"), "float"),
}
"""Functions of ``math`` with one argument, and the kind that they return."""
_BASIC = {"round": "int", "int": "int", "float": "float"}
_OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod)


def kind_of(node: ast.expr, known: Kinds, calls: Kinds) -> Kind | None:
    """The kind of an expression's value; None where it is not certain.

    Args:
        node: The expression.
        known: Kinds of the variables.
        calls: Kinds that functions return.
    """

    def inner(child: ast.expr) -> Kind | None:
        return kind_of(child, known, calls)

    match node:
        case ast.Constant(value=bool() | int() | float() | str() as value):
            return type(value).__name__
        case ast.Name(id=name):
            return known.get(name)
        case ast.Attribute(value=ast.Name(id="math"), attr="pi" | "tau"):
            return "float"
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            return "bool" if inner(operand) is not None else None
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return _number(inner(operand))
        case ast.BinOp(left=left, op=op, right=right):
            return _combined(inner(left), op, inner(right))
        case ast.BoolOp(values=values):
            return "bool" if {inner(v) for v in values} == {"bool"} else None
        case ast.Compare(left=left, comparators=others):
            return "bool" if joined(inner(n) for n in (left, *others)) is not None else None
        case ast.IfExp(test=test, body=body, orelse=other):
            return joined((inner(body), inner(other))) if inner(test) == "bool" else None
        case ast.Tuple(elts=elements):
            found = [inner(e) for e in elements]
            return None if None in found else ("tuple", *found)
        case ast.List(elts=elements):
            element = joined(inner(e) for e in elements)
            return ("list", element) if element is not None or not elements else None
        case ast.Call(func=function, args=arguments, keywords=[]):
            return _called(function, [inner(a) for a in arguments], calls)
    return None


def joined(kinds: Iterable[Kind | None]) -> Kind | None:
    """The kind that values of several kinds have in common, if they have one."""
    found = list(kinds)
    return reduce(_join, found) if found else None


def _join(one: Kind, other: Kind) -> Kind:
    if one == other:
        return one
    if {one, other} == set(NUMBERS):
        return "float"
    if _is_list(one) and _is_list(other):
        element = other[1] if one[1] is None else one[1]
        element = element if None in (one[1], other[1]) else _join(one[1], other[1])
        return None if element is None else ("list", element)
    if _is_tuple(one) and _is_tuple(other) and len(one) == len(other):
        parts = [_join(*pair) for pair in zip(one[1:], other[1:], strict=True)]
        return None if None in parts else ("tuple", *parts)
    return None


def names_in(node: ast.AST) -> set[str]:
    """The names that a piece of a program reads."""
    names = (n for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load))
    return {n.id for n in names}


def needs_int(name: str, body: Iterable[ast.stmt]) -> bool:
    """True if a variable must be a whole number: it counts, or others that count depend on it.

    It need not be one where it only is a component of a tuple, is compared, divided or rounded.
    """
    return any(_counts(name, node) for statement in body for node in _expressions(statement))


def _counts(name: str, node: ast.AST) -> bool:
    if isinstance(node, ast.Name):
        return node.id == name and isinstance(node.ctx, ast.Load)
    if isinstance(node, (ast.Tuple, ast.Compare)):
        return False
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
        return False
    if isinstance(node, ast.Call) and _last_name(node.func) in {*_MATH, *_BASIC}:
        return False
    return any(_counts(name, child) for child in ast.iter_child_nodes(node))


def _expressions(node: ast.AST) -> Iterator[ast.AST]:
    """The outermost expressions of a statement, its bodies included."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.expr):
            yield child
        else:
            yield from _expressions(child)


def _last_name(function: ast.expr) -> str:
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def _combined(left: Kind | None, op: ast.operator, right: Kind | None) -> Kind | None:
    if isinstance(op, ast.Mult) and _is_list(left):
        return left if right == "int" else None
    if isinstance(op, ast.Add) and _is_list(left) and _is_list(right):
        return joined((left, right))
    if _number(left) is None or _number(right) is None or not isinstance(op, _OPERATORS):
        return None
    return "float" if isinstance(op, ast.Div) else joined((left, right))


def _called(function: ast.expr, given: list[Kind | None], calls: Kinds) -> Kind | None:
    if isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name):
        module, name = function.value.id, function.attr
        if module == "time":
            return "float" if (name, given) == ("time", []) else None
        known = module == "math" and len(given) == 1 and given[0] in NUMBERS
        return _MATH.get(name) if known else None
    name = function.id if isinstance(function, ast.Name) else ""
    if name in calls:
        return calls[name] if not given else None
    if name == "len":
        return "int" if len(given) == 1 and _is_list(given[0]) else None
    if any(kind not in NUMBERS for kind in given):
        return None
    if name in ("max", "min"):
        return joined(given) if len(given) > 1 else None
    if len(given) != 1:
        return None
    return given[0] if name == "abs" else _BASIC.get(name)


def _number(kind: Kind | None) -> Kind | None:
    return kind if kind in NUMBERS else None


def _is_list(kind: Kind | None) -> bool:
    return isinstance(kind, tuple) and kind[0] == "list"


def _is_tuple(kind: Kind | None) -> bool:
    return isinstance(kind, tuple) and kind[0] == "tuple"
