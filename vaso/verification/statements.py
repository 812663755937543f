"""The statements of a plan, where they stand, and which of them must have run."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Collection, Iterator, Sequence
from typing import TypeAlias

__all__ = ["Place", "blocks", "last_line", "own_nodes", "place", "ran"]

_SIMPLE = (ast.Expr, ast.Assign, ast.AugAssign, ast.AnnAssign, ast.Pass, ast.Global, ast.Nonlocal)

Place: TypeAlias = tuple[int, int]
"""Line and column at which a statement begins."""


def place(statement: ast.stmt) -> Place:
    """Where a statement begins; no two begin at the same place."""
    return statement.lineno, statement.col_offset


def blocks(statement: ast.AST) -> Iterator[list[ast.stmt]]:
    """The blocks of a compound statement, a definition or a module."""
    for name in ("body", "orelse", "finalbody"):
        found = getattr(statement, name, None)
        if isinstance(found, list) and found:
            yield found
    for part in (*getattr(statement, "handlers", ()), *getattr(statement, "cases", ())):
        yield part.body


def own_nodes(statement: ast.stmt) -> Iterator[ast.AST]:
    """The expressions of a statement, without its blocks and without what runs at another time."""
    pending: list[ast.AST] = [
        c for c in ast.iter_child_nodes(statement) if isinstance(c, ast.expr | ast.withitem)
    ]
    while pending:
        node = pending.pop()
        yield node
        if not isinstance(node, ast.Lambda | ast.GeneratorExp):
            pending += [c for c in ast.iter_child_nodes(node) if not isinstance(c, ast.stmt)]


def last_line(statement: ast.stmt) -> int:
    """The last line of a simple statement, or of the head of a compound one."""
    if not any(blocks(statement)):
        return statement.end_lineno or statement.lineno
    heads = [n.end_lineno or 0 for n in own_nodes(statement) if isinstance(n, ast.expr)]
    return max([statement.lineno, *heads])


def ran(tree: ast.Module, lines: Collection[int], *, to_the_end: bool = False) -> set[Place]:
    """The statements that have run, given lines from which a call was made.

    A block runs from its first statement on, so what stands before a statement that ran has run as
    well, and so has what it stands in. Of several statements in one line, the first one has.

    Args:
        tree: The plan.
        lines: Lines from which a call was made.
        to_the_end: True where every behaviour was seen and no exception ends the plan. Then what
            follows a simple statement that ran has run as well.
    """
    before: dict[Place, list[Place]] = {}
    finishes = _Finishes(tree) if to_the_end else lambda _: False
    by_line: dict[int, Place] = {}
    for body, around in _all_blocks(tree):
        earlier = list(around)
        for statement in body:
            before[place(statement)] = list(earlier)
            for line in range(statement.lineno, last_line(statement) + 1):
                by_line[line] = min(by_line.get(line, place(statement)), place(statement))
            earlier.append(place(statement))
        for statement, follower in itertools.pairwise(body):
            if finishes(statement):
                before[place(statement)].append(place(follower))
    found: set[Place] = set()
    pending = [by_line[line] for line in lines if line in by_line]
    while pending:
        here = pending.pop()
        if here not in found:
            found.add(here)
            pending += before[here]
    return found


class _Finishes:
    """Tells simple statements after which the next one runs, in a plan without exceptions.

    That is: no jumps, and no calls of what the plan defines itself, which may never return.
    """

    def __init__(self, tree: ast.Module) -> None:
        nodes = list(ast.walk(tree))
        self.catches = any(isinstance(n, ast.Try | ast.With) for n in nodes)
        self.objects = any(isinstance(n, ast.ClassDef) for n in nodes)
        self.own = {n.name for n in nodes if isinstance(n, ast.FunctionDef)}

    def __call__(self, statement: ast.stmt) -> bool:
        if self.catches or not isinstance(statement, _SIMPLE):
            return False
        for node in ast.walk(statement):
            if isinstance(node, ast.Name) and node.id in self.own:
                return False
            if isinstance(node, ast.Call) and not self._returns(node.func):
                return False
        return True

    def _returns(self, function: ast.expr) -> bool:
        return isinstance(function, ast.Name) or (
            isinstance(function, ast.Attribute) and not self.objects
        )


def _all_blocks(tree: ast.Module) -> Iterator[tuple[Sequence[ast.stmt], Sequence[Place]]]:
    """Every block with the statement that it stands in."""
    pending: list[tuple[ast.AST, list[Place]]] = [(tree, [])]
    while pending:
        node, around = pending.pop()
        for body in blocks(node):
            yield body, around
            pending += [(statement, [place(statement)]) for statement in body]
