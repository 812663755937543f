"""Turn a plan's expressions into steps: evaluated from left to right, into temporaries."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any, TypeAlias, TypeGuard

from vaso.plan.abstraction.fields import Fields
from vaso.plan.abstraction.flow import ONE, Graph, Set, Stop, Use
from vaso.plan.abstraction.forms import CLOCK, GLOBAL, Affine, Var
from vaso.plan.abstraction.scopes import COMPREHENSIONS, Comprehension, Scope, Scopes, parameters

CLOCKS = frozenset({"time", "monotonic", "perf_counter"})
_PURE_MODULES = frozenset({"math"})
Span: TypeAlias = tuple[int, int]
"""The bytes of a call in the text."""

Place: TypeAlias = tuple[Any, ...]
"""The module or a function (by number), and the calls that lead from there to where steps run."""

MAX_DEPTH = 8
MAX_COPIED = 6_000
_MESSAGES = frozenset({"debug", "info", "warning", "error", "critical", "exception"})
_TEMPORARY = "%"
_RETURNED = "%return"
_SHOWN = frozenset({"round", "str", "int", "float", "format", "repr", "abs", "len"})
"""Functions that cannot fail because of a number's value (with arguments that are numbers)."""


class Expressions:
    """Lowers expressions.

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

    # --- values ----------------------------------------------------------------------------------

    def value(self, node: ast.expr, into: Var, after: int, scope: Scope) -> int:
        """Evaluate an expression into a variable."""
        if isinstance(node, ast.Constant):
            return self.graph.add(Set(into, _constant(node.value)), after)
        if isinstance(node, ast.Name):
            return self._load(node.id, into, after, scope)
        if (var := self.fields.variable(node, scope)) is not None:
            return self.graph.add(Set(into, Affine.of(var)), after)
        if isinstance(node, ast.BinOp):
            left, right = self.temporary(scope), self.temporary(scope)
            after = self.computed(node, (left, right), into, after)
            return self.value(node.left, left, self.value(node.right, right, after, scope), scope)
        if isinstance(node, ast.UnaryOp):
            return self._unary(node, into, after, scope)
        if isinstance(node, (ast.Compare, ast.BoolOp)):
            return self._logical(node, into, after, scope)
        if isinstance(node, ast.IfExp):
            yes = self.value(node.body, into, after, scope)
            no = self.value(node.orelse, into, after, scope)
            return self.condition(node.test, yes, no, scope)
        if isinstance(node, ast.Call):
            return self._call(node, into, after, scope)
        after = self.graph.add(Set(into), after)
        if isinstance(node, ast.Lambda):
            given = node.args
            return self.looked_at([*given.defaults, *filter(None, given.kw_defaults)], after, scope)
        if isinstance(node, COMPREHENSIONS):
            return self._comprehension(node, after, scope)
        return self.looked_at(_parts(node), after, scope)

    def looked_at(self, nodes: Iterable[ast.expr], after: int, scope: Scope) -> int:
        """Evaluate expressions whose exact values matter."""
        found = [(node, self.temporary(scope)) for node in nodes]
        for _, temporary in found:
            after = self.graph.add(Use(Affine.of(temporary)), after)
        for node, temporary in reversed(found):
            after = self.value(node, temporary, after, scope)
        return after

    def ignored(self, node: ast.expr, after: int, scope: Scope) -> int:
        """Evaluate an expression whose value is of no interest, as what is printed."""
        if isinstance(node, ast.JoinedStr):
            shown = [v for v in node.values if isinstance(v, ast.FormattedValue)]
            parts = [p for v in shown for p in (v.value, v.format_spec) if p is not None]
            return self._all_ignored(parts, after, scope)
        if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub)):
            return self._all_ignored([node.left, node.right], after, scope)
        if self.fields.variable(node, scope) is not None:
            held = self.temporary(scope)
            return self.value(
                node, held, self.graph.add(Use(Affine.of(held), "kind"), after), scope
            )
        if isinstance(node, ast.Name):
            held = self.temporary(scope)
            return self._load(
                node.id, held, self.graph.add(Use(Affine.of(held), "kind"), after), scope
            )
        if self._logs(node, scope):
            return self._all_ignored(node.args, after, scope)
        if _is_format(node):
            return self._all_ignored(node.args, after, scope)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            name = node.func.id
            plain = not node.keywords and not any(isinstance(a, ast.Starred) for a in node.args)
            own = self.scopes.owner(name, scope) is not None or self.scopes.hidden(name, scope)
            if name == "print" and not own:
                given = [*node.args, *(k.value for k in node.keywords)]
                return self._all_ignored(given, after, scope)
            if name in _SHOWN and plain and not own:
                return self._all_ignored(node.args, after, scope)
        return self.value(node, self.temporary(scope), after, scope)

    def _logs(self, node: ast.expr, scope: Scope) -> TypeGuard[ast.Call]:
        """A message for the log, which is not written here."""
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
            return False
        root = node.func.value
        plain = not node.keywords and not any(isinstance(a, ast.Starred) for a in node.args)
        if node.func.attr not in _MESSAGES or not isinstance(root, ast.Name) or not plain:
            return False
        var = self.scopes.owner(root.id, scope)
        if var is None:
            return root.id == "logging" and not self.scopes.hidden(root.id, scope)
        return var in self.scopes.loggers

    def _all_ignored(self, nodes: Sequence[ast.expr], after: int, scope: Scope) -> int:
        for node in reversed(nodes):
            after = self.ignored(node, after, scope)
        return after

    def _load(self, name: str, into: Var, after: int, scope: Scope) -> int:
        var = self.scopes.owner(name, scope)
        known = var is not None and var not in self.scopes.untracked
        return self.graph.add(Set(into, Affine.of(var) if var and known else None), after)

    def computed(
        self, node: ast.BinOp | ast.AugAssign, sides: tuple[Var, Var], into: Var, after: int
    ) -> int:
        """``into = left op right``, for the two sides' values."""
        one, two = (Affine.of(side) for side in sides)
        value: Affine | None = None
        if isinstance(node.op, (ast.Add, ast.Sub)):
            value = one.plus(two, ONE if isinstance(node.op, ast.Add) else -ONE)
        elif isinstance(node.op, ast.Mult):
            left, right = _number(getattr(node, "left", None)), _number(_right(node))
            factor, other = (right, one) if right is not None else (left, two)
            value = None if factor is None else Affine({}).plus(other, factor)
        elif isinstance(node.op, ast.Div) and (divisor := _number(_right(node))):
            value = Affine({}).plus(one, 1 / divisor)
        if value is not None:
            return self.graph.add(Set(into, value), after)
        done = self.graph.add(Set(into), after)
        return self.graph.add(Use(one), self.graph.add(Use(two), done))

    def _unary(self, node: ast.UnaryOp, into: Var, after: int, scope: Scope) -> int:
        operand = self.temporary(scope)
        if isinstance(node.op, ast.USub):
            done = self.graph.add(Set(into, Affine({}).plus(Affine.of(operand), -ONE)), after)
        elif isinstance(node.op, ast.Not):
            done = self.graph.add(Use(Affine.of(operand), "sign"), self.graph.add(Set(into), after))
        else:
            done = self.graph.add(Use(Affine.of(operand)), self.graph.add(Set(into), after))
        return self.value(node.operand, operand, done, scope)

    def _logical(self, node: ast.Compare | ast.BoolOp, into: Var, after: int, scope: Scope) -> int:
        """A comparison, or an ``and`` or ``or``, as a value."""
        if isinstance(node, ast.Compare):
            done = self.graph.add(Set(into), after)
            return self.condition(node, done, done, scope)
        last = node.values[-1]
        following = self.value(last, into, after, scope)
        for part in reversed(node.values[:-1]):
            held = self.temporary(scope)
            taken = self.graph.add(Set(into, Affine.of(held)), after)
            choice = self.graph.join()
            self.graph.link(choice, taken, following)
            test = self.graph.add(Use(Affine.of(held), "sign"), choice)
            following = self.value(part, held, test, scope)
        return following

    def _comprehension(self, node: Comprehension, after: int, scope: Scope) -> int:
        """A loop over everything in it; ``after`` comes when it ends."""
        inner = self.scopes.of[node]
        head = self.graph.join()
        parts = [node.key, node.value] if isinstance(node, ast.DictComp) else [node.elt]
        for generator in node.generators[1:]:
            parts.append(generator.iter)
        parts += [test for generator in node.generators for test in generator.ifs]
        body = head
        for part in parts:
            branch = self.graph.join()
            self.graph.link(branch, self.looked_at([part], body, inner), head)
            body = branch
        self.graph.link(head, body, after)
        return self.looked_at(
            [node.generators[0].iter], self.may_call(self.scopes.loose, head, scope), scope
        )

    # --- conditions ------------------------------------------------------------------------------

    def condition(self, node: ast.expr, yes: int, no: int, scope: Scope) -> int:
        """Evaluate a condition and go one way or the other."""
        if isinstance(node, ast.Constant):
            return yes if node.value else no
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            return self.condition(node.operand, no, yes, scope)
        if isinstance(node, ast.BoolOp):
            for part in reversed(node.values):
                if isinstance(node.op, ast.And):
                    yes = self.condition(part, yes, no, scope)
                else:
                    no = self.condition(part, yes, no, scope)
            return yes if isinstance(node.op, ast.And) else no
        if isinstance(node, ast.Compare):
            return self._comparison(node, yes, no, scope)
        choice = self.graph.join()
        self.graph.link(choice, yes, no)
        held = self.temporary(scope)
        test = self.graph.add(Use(Affine.of(held), "sign"), choice)
        return self.value(node, held, test, scope)

    def _comparison(self, node: ast.Compare, yes: int, no: int, scope: Scope) -> int:
        held = [self.temporary(scope) for _ in (node.left, *node.comparators)]
        following = yes
        for index in range(len(node.ops) - 1, -1, -1):
            choice = self.graph.join()
            self.graph.link(choice, following, no)
            pair = held[index], held[index + 1]
            test = self._compared(node.ops[index], pair, choice)
            following = self.value(node.comparators[index], held[index + 1], test, scope)
        return self.value(node.left, held[0], following, scope)

    def _compared(self, op: ast.cmpop, pair: tuple[Var, Var], after: int) -> int:
        one, two = (Affine.of(var) for var in pair)
        if isinstance(op, (ast.Is, ast.IsNot)):
            after = self.graph.add(Use(two, "kind"), after)
            return self.graph.add(Use(one, "kind"), after)
        if isinstance(op, (ast.In, ast.NotIn)):
            return self.graph.add(Use(one), self.graph.add(Use(two), after))
        return self.graph.add(Use(one.plus(two, -ONE), "sign"), after)

    # --- stores ----------------------------------------------------------------------------------

    def stored(self, target: ast.expr, source: Var, after: int, scope: Scope) -> int:
        """Store a value in a target."""
        if isinstance(target, ast.Name):
            var = self.scopes.owner(target.id, scope)
            if var is not None and var not in self.scopes.untracked:
                return self.graph.add(Set(var, Affine.of(source)), after)
            return self.graph.add(Use(Affine.of(source)), after)
        if (var := self.fields.variable(target, scope)) is not None:
            return self.graph.add(Set(var, Affine.of(source)), after)
        if isinstance(target, ast.Starred):
            return self.stored(target.value, source, after, scope)
        if isinstance(target, (ast.Tuple, ast.List)):
            for part in reversed(target.elts):
                piece = self.temporary(scope)
                stored = self.stored(part, piece, after, scope)
                after = self.graph.add(Set(piece), stored)
            return self.graph.add(Use(Affine.of(source)), after)
        parts = [target.value] if isinstance(target, ast.Attribute) else _parts(target)
        after = self.looked_at(parts, after, scope)
        return self.graph.add(Use(Affine.of(source)), after)

    # --- calls -----------------------------------------------------------------------------------

    def _call(self, node: ast.Call, into: Var, after: int, scope: Scope) -> int:
        number = self.scopes.called(node.func, scope)
        if number is not None:
            return self._own_call(node, number, into, after, scope)
        if (number := self.fields.method(node.func, scope)) is not None:
            return self._own_call(node, number, into, after, scope, bound=True)
        given = [*node.args, *(k.value for k in node.keywords)]
        if self._reads_clock(node.func, scope):
            stop = self._stop(node, into, after, clock=True)
            return self.looked_at(given, stop, scope)
        if isinstance(node.func, ast.Name) and self._identity(node, scope):
            return self.value(node.args[0], into, after, scope)
        # Any other call may be one of the host's, and may call what it can get hold of.
        back = self.may_call(self.scopes.calling(node.func, scope), after, scope)
        stop = self._stop(node, into, back, clock=False)
        parts = [] if isinstance(node.func, ast.Name) else [node.func]
        if self._module(node.func, scope):
            parts = []
        return self.looked_at([*parts, *given], stop, scope)

    def _stop(self, node: ast.Call, into: Var, after: int, clock: bool) -> int:
        span = self.span(node)
        done = self.graph.add(Set(into, Affine.of(CLOCK) if clock else None), after)
        stop = self.graph.add(Stop(span, clock), done)
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
                first = self.graph.add(Set(var, _constant(getattr(value, "value", None))), first)
            if var in self.scopes.untracked and value is not None and id(value) in held:
                first = self.graph.add(Use(Affine.of(held[id(value)])), first)
        for value in reversed(values):
            first = self.value(value, held[id(value)], first, scope)
        return first

    def body(self, number: int, leave: int) -> int:
        """A copy of a function's body; its first step."""
        raise NotImplementedError

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

    def _reads_clock(self, func: ast.expr, scope: Scope) -> bool:
        if isinstance(func, ast.Attribute) and isinstance(func.value, ast.Name):
            return func.attr in CLOCKS and self._imports(func.value.id, scope, "time", None)
        if isinstance(func, ast.Name):
            return any(self._imports(func.id, scope, "time", name) for name in CLOCKS)
        return False

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


def _is_format(node: ast.expr) -> TypeGuard[ast.Call]:
    """``"…".format(…)`` without keywords."""
    return (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "format"
        and isinstance(node.func.value, ast.Constant)
        and not node.keywords
        and not any(isinstance(a, ast.Starred) for a in node.args)
    )


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


def _constant(value: object) -> Affine | None:
    """A literal number as a form; None for any other literal."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        return Affine({}, Fraction(value))
    except (ValueError, OverflowError):
        return None


def _right(node: ast.BinOp | ast.AugAssign) -> ast.expr:
    return node.right if isinstance(node, ast.BinOp) else node.value


def _number(node: ast.expr | None) -> Fraction | None:
    """The value of a literal number."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        inner = _number(node.operand)
        return None if inner is None else -inner
    found = _constant(node.value) if isinstance(node, ast.Constant) else None
    return None if found is None else found.constant


def _parts(node: ast.AST) -> list[ast.expr]:
    """The expressions that an expression is made of."""
    found: list[ast.expr] = []
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.expr):
            found.append(child)
        elif not isinstance(child, ast.expr_context):
            found += _parts(child)
    return found
