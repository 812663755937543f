"""Constructs that the sandbox silently runs otherwise than CPython: plans may not use them.

Found by running expressions and programs in both (``tests/plan/test_differences.py``).
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator

from vaso.errors import UnsupportedPlanError
from vaso.plan.nodes import nodes

_EAGER = frozenset({"list", "tuple", "set", "frozenset", "dict", "sorted", "sum", "min", "max"})
_ORDERLESS = frozenset({"sorted", "sum", "min", "max", "any", "all", "len", "set", "frozenset"})
_MISSING = frozenset({"hasattr", "callable", "vars", "delattr"})
_PROCESSOR_TIME = frozenset({"process_time", "thread_time", "process_time_ns", "thread_time_ns"})
_SETS = (ast.Set, ast.SetComp)


def check_differences(tree: ast.AST, name: str, acting: Collection[str]) -> None:
    """Refuse what would mean something else on the robot.

    Args:
        tree: The plan.
        name: How messages call it.
        acting: Functions that may send a command.

    Raises:
        UnsupportedPlanError: With the construct, its line and what to write instead.
    """
    own = {n.name for n in nodes(tree) if isinstance(n, ast.FunctionDef)}
    parents = {c: node for node in nodes(tree) for c in ast.iter_child_nodes(node)}
    found = [
        *_eager_generators(tree, own | set(acting)),
        *_eager_maps(tree, own | set(acting), parents),
        *_set_orders(tree, parents),
        *_truth_of_objects(tree),
        *_missing(tree),
        *_processor_time(tree),
    ]
    for node, what, instead in sorted(found, key=lambda f: getattr(f[0], "lineno", 0)):
        raise UnsupportedPlanError(
            what, source=name, line=getattr(node, "lineno", None), expected=instead
        )


_Found = tuple[ast.AST, str, str]


def _eager_generators(tree: ast.AST, functions: set[str]) -> Iterator[_Found]:
    """The sandbox runs a generator expression to its end at once, so it must not act."""
    for node in nodes(tree):
        if isinstance(node, ast.GeneratorExp) and (used := _names(node) & functions):
            listed = ", ".join(sorted(used))
            yield node, f"a generator expression calls {listed}", "a loop, or a list in brackets"


def _eager_maps(
    tree: ast.AST, functions: set[str], parents: dict[ast.AST, ast.AST]
) -> Iterator[_Found]:
    for node in nodes(tree):
        used = _names(node) & functions if _called(node) in ("map", "filter") else set()
        if used and _called(parents.get(node)) not in _EAGER:
            what = f"'{_called(node)}' calls {', '.join(sorted(used))} one by one"
            yield node, what, f"a loop, or list({_called(node)}(…))"


def _set_orders(tree: ast.AST, parents: dict[ast.AST, ast.AST]) -> Iterator[_Found]:
    """The order of a set's elements differs, and may differ from run to run in CPython."""
    sets = {
        target.id
        for node in nodes(tree)
        if isinstance(node, ast.Assign) and _is_set(node.value, set())
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    instead = "a list or a tuple, or sorted(…)"
    for node in nodes(tree):
        if isinstance(node, (ast.For, ast.comprehension)) and _is_set(node.iter, sets):
            outer = parents.get(node)
            plain = isinstance(node, ast.comprehension) and (
                isinstance(outer, ast.SetComp)
                or _called(outer and parents.get(outer)) in _ORDERLESS
            )
            if not plain:
                yield node.iter, "a loop goes through a set, which has no order", instead
        elif isinstance(node, ast.Call) and _takes_order(node) and node.args:
            if _is_set(node.args[0], sets):
                yield node, "a set, which has no order, is put into one", instead
        elif _pops(node) and _is_set(node.func.value, sets):  # type: ignore[attr-defined]
            yield node, "'pop' takes any element of a set", instead


def _takes_order(node: ast.Call) -> bool:
    return _called(node) in ("list", "tuple", "enumerate", "iter", "zip", "map", "filter")


def _pops(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "pop"
        and not node.args
    )


def _is_set(node: ast.AST, names: set[str]) -> bool:
    if isinstance(node, ast.Name):
        return node.id in names
    return isinstance(node, _SETS) or _called(node) in ("set", "frozenset")


def _truth_of_objects(tree: ast.AST) -> Iterator[_Found]:
    for node in nodes(tree):
        if isinstance(node, ast.ClassDef):
            for method in node.body:
                if isinstance(method, ast.FunctionDef) and method.name in ("__bool__", "__len__"):
                    yield method, f"a class defines '{method.name}'", "a method with another name"


def _missing(tree: ast.AST) -> Iterator[_Found]:
    for node in nodes(tree):
        if isinstance(node, ast.Call) and _called(node) in _MISSING:
            yield node, f"the plan calls '{_called(node)}'", "a value that the plan keeps itself"


def _processor_time(tree: ast.AST) -> Iterator[_Found]:
    """Processor time does not pass in the sandbox."""
    for node in nodes(tree):
        used = {a.name for a in node.names} if isinstance(node, ast.ImportFrom) else set()
        used |= {node.attr} if isinstance(node, ast.Attribute) else set()
        if refused := sorted(used & _PROCESSOR_TIME):
            what = f"the plan uses {', '.join(refused)}, which stands still here"
            yield node, what, "time.time() or time.monotonic()"


def _names(node: ast.AST) -> set[str]:
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}


def _called(node: ast.AST | None) -> str:
    """The name of the function that a node calls, if it is a call of a name."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return node.func.id
    return ""
