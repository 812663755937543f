"""A plan must not give new meanings to names that the labelling code relies on.

Plan and labelling code run apart, so that a plan cannot change what its functions do. Where both
are one program, a plan's ``def set_velocity(…)`` would replace the one that ``forward()`` calls,
and what was verified would not be what runs. So such a plan is not supported.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Mapping

from vaso.errors import UnsupportedPlanError
from vaso.plan.nodes import annotations_in, nodes
from vaso.plan.toplevel import bindings


def check_shadowing(
    plan: ast.Module, labelling: ast.Module, *, constants: Collection[str], name: str
) -> None:
    """Check a plan against the labelling code that it runs with.

    A copy of a function of the labelling code is fine, and so is a plan that brings its own version
    of every function it calls.

    Args:
        plan: The plan.
        labelling: The labelling code.
        constants: Its module-level constants, which a plan may set.
        name: How messages call the plan.

    Raises:
        UnsupportedPlanError: A function of the labelling code that the plan calls uses a name that
            the plan binds to something else.
    """
    functions = {n.name: n for n in labelling.body if isinstance(n, ast.FunctionDef)}
    own = {bound: line for statement in plan.body for line, bound in bindings(statement)}
    copies = {
        n.name
        for n in plan.body
        if isinstance(n, ast.FunctionDef) and _same(n, functions.get(n.name))
    }
    shadowed = set(own) - set(constants) - copies
    called = {n.id for n in nodes(plan) if isinstance(n, ast.Name)} & set(functions) - set(own)
    for function in sorted(_closure(called, functions, set(own))):
        if changed := sorted(_reads(functions[function]) & shadowed):
            raise UnsupportedPlanError(
                f"the plan redefines '{changed[0]}', which '{function}' of the labelling code uses",
                source=name,
                line=own[changed[0]],
                hint="give it another name, or change the labelling code",
            )


def _closure(called: set[str], functions: Mapping[str, ast.FunctionDef], own: set[str]) -> set[str]:
    """The functions that run where some are called, apart from the plan's own."""
    found: set[str] = set()
    todo = list(called)
    while todo:
        function = todo.pop()
        if function not in found:
            found.add(function)
            todo += (_reads(functions[function]) & set(functions)) - own
    return found


def _reads(function: ast.FunctionDef) -> set[str]:
    """Names of the module, or built in, that a function reads when it runs."""
    notes = {id(part) for note in annotations_in(function) for part in ast.walk(note)}
    names = [n for n in ast.walk(function) if isinstance(n, ast.Name) and id(n) not in notes]
    shared = {n for g in ast.walk(function) if isinstance(g, ast.Global) for n in g.names}
    local = {n.id for n in names if not isinstance(n.ctx, ast.Load)}
    local |= {a.arg for a in ast.walk(function) if isinstance(a, ast.arg)}
    return {n.id for n in names if isinstance(n.ctx, ast.Load)} - (local - shared)


def _same(function: ast.FunctionDef, other: ast.FunctionDef | None) -> bool:
    """True for functions that do the same, line for line; annotations and docstrings aside."""
    return other is not None and _meaning(function) == _meaning(other)


def _meaning(function: ast.FunctionDef) -> tuple[str, ...]:
    body = function.body
    first = body[0]
    if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
        body = body[1:]
    arguments = [a.arg for a in ast.walk(function.args) if isinstance(a, ast.arg)]
    defaults = [d for d in (*function.args.defaults, *function.args.kw_defaults) if d is not None]
    return (*arguments, *map(ast.dump, defaults), *map(ast.dump, body))
