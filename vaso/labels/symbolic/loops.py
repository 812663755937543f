"""Loops over set-points of which all but the last few are not known."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from vaso.labels.symbolic.history import History, Tail
from vaso.labels.symbolic.interpreter import Interpreter, assigned
from vaso.labels.symbolic.paths import Path
from vaso.labels.symbolic.values import (
    Bound,
    Class,
    Function,
    NotUnderstoodError,
    Value,
    is_symbolic,
    is_term,
)

__all__ = ["Loop", "Loops"]

_LEAVES = (ast.Return, ast.Break, ast.Raise, ast.Assert, ast.Yield, ast.YieldFrom, ast.Await)
Quantities = dict[str, Value]


@dataclass(frozen=True, eq=False)
class Loop:
    """A loop over set-points as it begins.

    It must do the same however many set-points there are: begin with constants, read nothing else
    that is not known, and have no other way out.

    Attributes:
        node: The loop.
        known: The variables of its function when it begins.
        names: Finds global names.
    """

    node: ast.For
    known: Quantities
    names: Any

    def __post_init__(self) -> None:
        if any(isinstance(n, _LEAVES) for s in self.node.body for n in ast.walk(s)):
            raise NotUnderstoodError("a loop over set-points with another way out")
        for name in (*self.changed, *self.lists, *self.read):
            value = self.known.get(name)
            simple = isinstance(value, Class | Bound)
            simple |= isinstance(value, Function) and not value.outer
            if not simple and (is_symbolic(value) or isinstance(value, Function)):
                raise NotUnderstoodError(f"a loop that uses {name}, which is not constant")
        for name in self.changed:
            if not isinstance(self.known[name], bool | int | float):
                raise NotUnderstoodError("a loop with a variable that is no number")
        for name in self.lists:
            if sum(self.known[name] is v for v in self.known.values()) > 1:
                raise NotUnderstoodError("a list with two names")
            self.known[name] = list(self.known[name])  # as it is now; the loop appends to it

    @property
    def changed(self) -> list[str]:
        """Variables that outlive a turn."""
        return [n for n in sorted(set(assigned(self.node.body)) - self._targets) if n in self.known]

    @property
    def lists(self) -> list[str]:
        """Lists to which it appends."""
        return sorted(n for n in _appended(self.node) if n in self.known)

    @property
    def read(self) -> list[str]:
        """What else it reads."""
        read = {n.id for s in self.node.body for n in ast.walk(s) if isinstance(n, ast.Name)}
        own = {*assigned(self.node.body), *self._targets, *self.lists}
        return sorted(n for n in read - own if n in self.known)

    @property
    def _targets(self) -> set[str]:
        return {n.id for n in ast.walk(self.node.target) if isinstance(n, ast.Name)}

    @property
    def key(self) -> tuple[int, int]:
        """Where it is."""
        return self.node.lineno, self.node.col_offset

    def quantity(self, name: str) -> str:
        """A variable of the loop among all quantities."""
        return f"loop {self.key[0]}:{self.key[1]} {name}"

    def begins_like(self, other: Loop) -> bool:
        """True where it begins like another run of the same loop."""
        names = (*self.changed, *self.lists, *self.read)
        if names != (*other.changed, *other.lists, *other.read):
            return False
        return all(_alike(self.known[n], other.known[n]) for n in names)

    def anywhere(self, path: Path) -> Quantities:
        """Variables after any number of set-points: those of the loop are not known."""
        bound = {*assigned(self.node.body), *self._targets}
        found = {n: v for n, v in self.known.items() if n not in bound}
        for name in self.changed:
            sort = "bool" if isinstance(self.known[name], bool) else "real"
            found[name] = path.fresh(name, sort)
        return found | {name: Tail() for name in self.lists}

    def at_rest(self, after: Quantities) -> Quantities:
        """Variables after the set-point at rest.

        Args:
            after: The values of its variables then, as :meth:`quantities` gives them.
        """
        found = {n: list(v) if isinstance(v, list) else v for n, v in self.known.items()}
        return found | {name: after[self.quantity(name)] for name in self.changed}

    def quantities(self, known: Quantities) -> Quantities:
        """The values of its variables."""
        for name in self.changed:
            if not (is_term(known[name]) or isinstance(known[name], bool | int | float)):
                raise NotUnderstoodError("a loop with a variable that is no number")
        return {self.quantity(name): known[name] for name in self.changed}


@dataclass
class Loops:
    """Runs loops over set-points, and notes them.

    Attributes:
        base: The loops of the run on the robot at rest, in later runs.
        assume: Told of the values that the variables of such a loop have; assumes what it knows.
        found: The loops of this run.
        after: The variables of each loop after the set-points that are known.
    """

    base: dict[tuple[int, int], Loop] | None = None
    assume: Callable[[Quantities], None] | None = None
    found: dict[tuple[int, int], Loop] = field(default_factory=dict)
    after: Quantities = field(default_factory=dict)

    def __call__(self, run: Interpreter, node: ast.For, items: History, known: Quantities) -> None:
        """Run one loop."""
        loop = Loop(node, dict(known), run.names)
        for other in (self.found.get(loop.key), (self.base or {}).get(loop.key)):
            if other is not None and not loop.begins_like(other):
                raise NotUnderstoodError("a loop that begins in different ways")
        self.found[loop.key] = loop
        if items.known is not None:
            run.turns(node, [*items.known, *items.end])
            self.after |= loop.quantities(known)
            return
        anywhere = loop.anywhere(run.path)
        known.clear()
        known.update(anywhere)
        if self.assume is not None and loop.key in (self.base or {}):
            self.assume(loop.quantities(known))
        run.turns(node, list(items.end))


def _alike(one: Value, other: Value) -> bool:
    if isinstance(one, Function) and isinstance(other, Function):
        return one.node is other.node
    if isinstance(one, Class | Bound) or isinstance(other, Class | Bound):
        return isinstance(one, Class) and isinstance(other, Class) and one.name == other.name
    return type(one) is type(other) and bool(one == other)


def _appended(node: ast.For) -> set[str]:
    """Lists to which the body of a loop appends."""
    return {
        n.func.value.id
        for s in node.body
        for n in ast.walk(s)
        if isinstance(n, ast.Call)
        and isinstance(n.func, ast.Attribute)
        and isinstance(n.func.value, ast.Name)
        and n.func.attr == "append"
    }
