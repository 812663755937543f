"""Turn a plan's calls into steps: of its own functions, of the host's, of Python's."""

from __future__ import annotations

import ast
from abc import ABC, abstractmethod
from collections.abc import Iterable
from fractions import Fraction
from typing import Any, TypeAlias

from vaso.plan.abstraction.fields import Fields
from vaso.plan.abstraction.flow import Graph, Set, Stop, Use
from vaso.plan.abstraction.forms import CLOCK, GLOBAL, WALL, Affine, Var
from vaso.plan.abstraction.scopes import Scope, Scopes, parameters

CLOCKS = {"time": Fraction(0), "monotonic": -WALL, "perf_counter": -WALL}
"""The functions that tell the time, and what they are ahead of ``CLOCK``."""

_PURE_MODULES = frozenset({"math"})

Span: TypeAlias = tuple[int, int]
"""The bytes of a call in the text."""

Place: TypeAlias = tuple[Any, ...]
"""The module or a function (by number), and the calls that lead from there to where steps run."""

MAX_DEPTH = 8
MAX_COPIED = 6_000
_TEMPORARY = "%"
_RETURNED = "%return"


class Calls(ABC):
    """Lowers calls.

    Args:
        text: The program.
        scopes: Its scopes.
        fields: Its classes with a single object.
        graph: Where the steps go.

    Attributes:
        place: Where the steps that are made now run.
        own: The calls that have a copy of the function's steps of their own, so that it returns
            nowhere else.
        entries: The first step of the copy of each function that all other calls share.
        callbacks: The same for calls that nothing is known about.
        exits: The last step of those copies.
        pending: The functions whose copies are used and not made yet.
        stops: The steps that stand for a call, by their place and the call's bytes in the text.
        calls: Which functions each function may call.
    """

    def __init__(self, text: str, scopes: Scopes, fields: Fields, graph: Graph) -> None:
        self.scopes, self.fields, self.graph = scopes, fields, graph
        count = len(scopes.functions)
        self.entries = [graph.join() for _ in range(count)]
        self.callbacks = [graph.join() for _ in range(count)]
        self.exits = [graph.join() for _ in range(count)]
        self.place: Place = (GLOBAL,)
        self.own: set[tuple[Place, Span]] = set()
        self.pending: list[int] = []
        self._asked: set[int] = set()
        self._target: dict[Place, int] = {}
        self.stops: dict[tuple[Place, Span], list[int]] = {}
        self.calls: set[tuple[int, int]] = set()
        self._starts = [0]
        for line in text.encode().split(b"\n"):
            self._starts.append(self._starts[-1] + len(line) + 1)
        self._temporaries = 0

    def temporary(self, scope: Scope) -> Var:
        """A new variable for an intermediate result."""
        self._temporaries += 1
        return (scope.number, f"{_TEMPORARY}{self._temporaries}")

    def returned(self, function: int) -> Var:
        """The variable for what a function returns."""
        return (function, _RETURNED)

    @abstractmethod
    def value(self, node: ast.expr, into: Var, after: int, scope: Scope) -> int:
        """Evaluate an expression into a variable."""

    @abstractmethod
    def looked_at(self, nodes: Iterable[ast.expr], after: int, scope: Scope) -> int:
        """Evaluate expressions whose exact values matter."""

    def call(self, node: ast.Call, into: Var, after: int, scope: Scope) -> int:
        """Evaluate a call into a variable."""
        number = self.scopes.called(node.func, scope)
        if number is not None:
            return self._own_call(node, number, into, after, scope)
        if (number := self.fields.method(node.func, scope)) is not None:
            return self._own_call(node, number, into, after, scope, bound=True)
        given = [*node.args, *(k.value for k in node.keywords)]
        if (ahead := self._clock(node.func, scope)) is not None:
            stop = self._stop(node, into, after, Affine({CLOCK: Fraction(1)}, ahead))
            return self.looked_at(given, stop, scope)
        if isinstance(node.func, ast.Name) and self._identity(node, scope):
            return self.value(node.args[0], into, after, scope)
        # Any other call may be one of the host's, and may call what it can get hold of.
        back = self.may_call(self.scopes.calling(node.func, scope), after, scope)
        stop = self._stop(node, into, back)
        parts = [] if isinstance(node.func, ast.Name) else [node.func]
        if self._module(node.func, scope):
            parts = []
        return self.looked_at([*parts, *given], stop, scope)

    def _stop(self, node: ast.Call, into: Var, after: int, shown: Affine | None = None) -> int:
        """A call of the host; ``shown`` is what it returns if it tells the time."""
        span = self.span(node)
        done = self.graph.add(Set(into, shown), after)
        stop = self.graph.add(Stop(span, shown is not None), done)
        self.stops.setdefault((self.place, span), []).append(stop)
        return stop

    def span(self, node: ast.expr) -> tuple[int, int]:
        """The bytes of an expression in the text."""
        start = self._starts[node.lineno - 1] + node.col_offset
        return start, self._starts[(node.end_lineno or 1) - 1] + (node.end_col_offset or 0)

    def may_call(self, functions: set[int], after: int, scope: Scope) -> int:
        """Any of some functions may be called, any number of times."""
        if not functions:
            return after
        choice = self.graph.join()
        self.graph.link(choice, after)
        for number in functions:
            self.calls.add((scope.number, number))
            self._share(number)
            self.graph.link(choice, self.callbacks[number])
            self.graph.link(self.exits[number], choice)
        return choice

    def _own_call(
        self,
        node: ast.Call,
        number: int,
        into: Var,
        after: int,
        scope: Scope,
        *,
        bound: bool = False,
    ) -> int:
        """A call of a function of the plan's, or (``bound``) of a method."""
        self.calls.add((scope.number, number))
        back = self.graph.add(Set(into, Affine.of(self.returned(number))), after)
        given = _assigned(node, self.scopes.functions[number], bound)
        values = [*node.args, *(k.value for k in node.keywords)]
        if given is None:
            self._share(number)
            self.graph.link(self.exits[number], back)
            return self.looked_at(values, self.callbacks[number], scope)
        first, held = (
            self._entry(node, number, back),
            {id(v): self.temporary(scope) for v in values},
        )
        for name, value in given.items():
            var = (number, name)
            if value is None or var in self.scopes.untracked:
                first = self.graph.add(Set(var), first)
            elif id(value) in held:
                first = self.graph.add(Set(var, Affine.of(held[id(value)])), first)
            else:
                first = self.graph.add(Set(var, constant(getattr(value, "value", None))), first)
            if var in self.scopes.untracked and value is not None and id(value) in held:
                first = self.graph.add(Use(Affine.of(held[id(value)])), first)
        for value in reversed(values):
            first = self.value(value, held[id(value)], first, scope)
        return first

    @abstractmethod
    def body(self, number: int, leave: int) -> int:
        """A copy of a function's body; its first step."""

    def _entry(self, node: ast.Call, number: int, back: int) -> int:
        """The first step of a function that goes back to a step."""
        span, outer = self.span(node), self.place
        running = {self._target.get(outer[: n + 1]) for n in range(1, len(outer))} | {outer[0]}
        if number in running or len(outer) > MAX_DEPTH or len(self.graph.steps) > MAX_COPIED:
            self._share(number)
            self.graph.link(self.exits[number], back)
            return self.entries[number]
        self.own.add((outer, span))
        self.place = (*outer, span)
        self._target[self.place] = number
        first = self.body(number, back)
        self.place = outer
        return first

    def _share(self, number: int) -> None:
        if number not in self._asked:
            self._asked.add(number)
            self.pending.append(number)

    def _identity(self, node: ast.Call, scope: Scope) -> bool:
        """``float(x)``, which leaves a number as it is."""
        assert isinstance(node.func, ast.Name)
        own = self.scopes.owner(node.func.id, scope) or self.scopes.hidden(node.func.id, scope)
        plain = len(node.args) == 1 and not isinstance(node.args[0], ast.Starred)
        return node.func.id == "float" and not own and plain and not node.keywords

    def _clock(self, func: ast.expr, scope: Scope) -> Fraction | None:
        """What a function that tells the time is ahead of the clock; None for any other one."""
        for name, ahead in CLOCKS.items():
            if isinstance(func, ast.Attribute) and isinstance(func.value, ast.Name):
                found = func.attr == name and self._imports(func.value.id, scope, "time", None)
            else:
                found = isinstance(func, ast.Name) and self._imports(func.id, scope, "time", name)
            if found:
                return ahead
        return None

    def _module(self, func: ast.expr, scope: Scope) -> bool:
        """True for a function of a module that neither stops nor calls back."""
        return (
            isinstance(func, ast.Attribute)
            and isinstance(func.value, ast.Name)
            and any(self._imports(func.value.id, scope, m, None) for m in (*_PURE_MODULES, "time"))
        )

    def _imports(self, name: str, scope: Scope, module: str, member: str | None) -> bool:
        """True if a name can only mean a module, or a member of one."""
        var = self.scopes.owner(name, scope)
        if var is None:
            return member is None and name == module and not self.scopes.hidden(name, scope)
        ways = self.scopes.bindings(var)
        return bool(ways) and all(_is_import(way, name, module, member) for way in ways)


def _is_import(way: ast.AST, name: str, module: str, member: str | None) -> bool:
    if isinstance(way, ast.Import):
        return member is None and any(
            a.name == module and (a.asname or a.name) == name for a in way.names
        )
    if isinstance(way, ast.ImportFrom):
        return way.module == module and any(
            a.name == member and (a.asname or a.name) == name for a in way.names
        )
    return False


def _assigned(
    node: ast.Call, function: ast.FunctionDef | ast.Lambda, bound: bool
) -> dict[str, ast.expr | None] | None:
    """What a call's parameters are; None where that depends on more than the text.

    A default that is no literal number is None: its value is kept with the function.
    """
    given = function.args
    starred = any(isinstance(a, ast.Starred) for a in node.args)
    if given.vararg or given.kwarg or starred or any(k.arg is None for k in node.keywords):
        return None
    names = parameters(function)
    positional = [a.arg for a in (*given.posonlyargs, *given.args)]
    defaults: dict[str, ast.expr | None] = dict(
        zip(positional[len(positional) - len(given.defaults) :], given.defaults, strict=True)
    )
    defaults |= {a.arg: d for a, d in zip(given.kwonlyargs, given.kw_defaults, strict=True)}
    found: dict[str, ast.expr | None] = {
        n: d if isinstance(d, ast.Constant) else None for n, d in defaults.items()
    }
    if bound:
        found[positional[0]] = None  # the object itself
    open_ones = positional[1:] if bound else positional
    if len(node.args) > len(open_ones):
        return None
    found.update(zip(open_ones, node.args, strict=False))
    found |= {k.arg: k.value for k in node.keywords if k.arg is not None}
    return found if set(found) == set(names) else None


def constant(value: object) -> Affine | None:
    """A literal number as a form; None for any other literal."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        return Affine({}, Fraction(value))
    except (ValueError, OverflowError):
        return None
