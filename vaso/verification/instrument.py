"""A copy of a plan that says which of its statements run.

Before each statement stands a call of a sensor that always says False, ``__vaso_point__(n)``. It
takes no time and decides nothing, so the copy does what the plan does, and exploration notes the
call like any other reading. A statement after one that cannot fail needs no call of its own.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

from vaso.verification.statements import Place, blocks, last_line, own_nodes, place

__all__ = ["POINT", "Instrumented", "Span", "instrument"]

POINT = "__vaso_point__"
"""The sensor. Names that begin with two underscores are not open to plans."""

_ONCE = f"""
__vaso_seen__ = {{}}
def __vaso_once__(point):
    if point not in __vaso_seen__:
        __vaso_seen__[point] = True
        {POINT}(point)
    return False
"""
_COMPOUND = (ast.If, ast.For, ast.While, ast.Try, ast.With, ast.Match)
_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


@dataclass(frozen=True, slots=True)
class Span:
    """Lines of a plan that run together: a simple statement, or the head of a compound one.

    Attributes:
        first: The first line.
        last: The last line.
        point: The point that is passed when they run; None for those of which it is known that
            they run.
    """

    first: int
    last: int
    point: int | None


@dataclass(frozen=True, slots=True)
class Choice:
    """A condition, with the points that are passed when it comes out one way or the other.

    Attributes:
        line: Its line.
        kind: ``if``, ``while`` or ``either`` (a conditional expression).
        yes: The point for true.
        no: The point for false.
    """

    line: int
    kind: str
    yes: int
    no: int


@dataclass
class Instrumented:
    """The copy.

    Attributes:
        text: Its text, with other line numbers than the plan's.
        spans: Which lines run at which point.
        choices: The conditions.
    """

    text: str = ""
    spans: list[Span] = field(default_factory=list)
    choices: list[Choice] = field(default_factory=list)


def instrument(
    source: str, known: Collection[str], ran: Collection[Place] = (), *, once: bool = False
) -> Instrumented:
    """Write the copy.

    Args:
        source: The plan's text; valid Python.
        known: Functions that the plan may call without defining them.
        ran: Statements that are known to run, and need no point.
        once: Pass every point only the first time, for plans that compute a lot in one step.
    """
    tree = ast.parse(source)
    writer = _Writer("__vaso_once__" if once else POINT, ran)
    writer.module(tree, known)
    head = ast.parse(_ONCE).body if once else []
    tree.body = [*head, *tree.body]
    writer.result.text = ast.unparse(ast.fix_missing_locations(tree)) + "\n"
    return writer.result


class _Writer:
    def __init__(self, function: str, ran: Collection[Place]) -> None:
        self.function = function
        self.ran = ran
        self.result = Instrumented()
        self.points = 0

    def module(self, tree: ast.Module, known: Collection[str]) -> None:
        """Leave the top level as it is up to the first statement that does something.

        What stands there are definitions and settings, and a call among them would change what the
        plan's entry point is.
        """
        acts = _Acting(tree, known)
        start = next((i for i, s in enumerate(tree.body) if acts(s)), len(tree.body))
        for statement in tree.body[:start]:
            self._inside(statement, None)
        tree.body[start:] = self._block(tree.body[start:])

    def _block(self, body: Sequence[ast.stmt]) -> list[ast.stmt]:
        """A block with its points."""
        found: list[ast.stmt] = []
        point: int | None = None
        follows = False
        for number, statement in enumerate(body):
            if place(statement) in self.ran:
                point = None
            elif not follows:
                point = self._new()
                found.append(ast.Expr(self._call(point)))
            after = body[number + 1] if number + 1 < len(body) else None
            if isinstance(statement, ast.If | ast.While) and not self._is_shown(statement, after):
                self._condition(statement)
            self._inside(statement, point)
            found.append(statement)
            follows = _cannot_fail(statement)
        return found

    def _inside(self, statement: ast.stmt, point: int | None) -> None:
        """Note a statement's lines, and put points into it."""
        self.result.spans.append(Span(statement.lineno, last_line(statement), point))
        for node in list(own_nodes(statement)):
            if isinstance(node, ast.IfExp):
                self._either(node)
        if isinstance(statement, ast.ClassDef):
            for inner in statement.body:  # its own statements run with it
                self._inside(inner, point)
            return
        for body in blocks(statement):
            body[:] = self._block(body)

    def _is_shown(self, statement: ast.If | ast.While, after: ast.stmt | None) -> bool:
        """True where lines show whether the condition is ever false."""
        if statement.orelse or isinstance(statement.test, ast.Constant):
            return True
        if after is None or place(after) not in self.ran:
            return False
        if isinstance(statement, ast.If):
            return isinstance(statement.body[-1], ast.Break | ast.Continue | ast.Return | ast.Raise)
        return not any(isinstance(n, ast.Break) for n in ast.walk(statement))

    def _condition(self, statement: ast.If | ast.While) -> None:
        """Note how a condition comes out."""
        yes, no = self._new(), self._new()
        kind = "while" if isinstance(statement, ast.While) else "if"
        self.result.choices.append(Choice(statement.lineno, kind, yes, no))
        true = ast.BoolOp(ast.And(), [statement.test, ast.UnaryOp(ast.Not(), self._call(yes))])
        statement.test = ast.BoolOp(ast.Or(), [true, self._call(no)])

    def _either(self, node: ast.IfExp) -> None:
        yes, no = self._new(), self._new()
        self.result.choices.append(Choice(node.test.lineno, "either", yes, no))
        node.body = ast.BoolOp(ast.Or(), [self._call(yes), node.body])
        node.orelse = ast.BoolOp(ast.Or(), [self._call(no), node.orelse])

    def _new(self) -> int:
        self.points += 1
        return self.points

    def _call(self, point: int) -> ast.Call:
        return ast.Call(ast.Name(self.function, ast.Load()), [ast.Constant(point)], [])


class _Acting:
    """Which top-level statements do something, by the standard of :mod:`vaso.plan.toplevel`."""

    def __init__(self, tree: ast.Module, known: Collection[str]) -> None:
        functions = {n.name for n in tree.body if isinstance(n, ast.FunctionDef)}
        classes = [n for n in tree.body if isinstance(n, ast.ClassDef)]
        own = [s for s in tree.body if not isinstance(s, _DEFINITIONS)]
        names = [n for s in own for n in ast.walk(s) if isinstance(n, ast.Name)]
        stored = {n.id for n in names if isinstance(n.ctx, ast.Store)}
        self.names = {*known, *functions, *(stored - set(dir(builtins)))}
        self.methods = {f.name for c in classes for f in c.body if isinstance(f, ast.FunctionDef)}
        self.names |= {c.name for c in classes if self._constructor_acts(c)}

    def __call__(self, statement: ast.stmt) -> bool:
        if isinstance(statement, _DEFINITIONS):
            return False
        return isinstance(statement, _COMPOUND) or any(map(self._call_acts, ast.walk(statement)))

    def _call_acts(self, node: ast.AST) -> bool:
        match node:
            case ast.Call(func=ast.Name(id=name)):
                return name in self.names
            case ast.Call(func=ast.Attribute(attr=name)):
                return name in self.methods
        return isinstance(node, ast.Call)

    def _constructor_acts(self, node: ast.ClassDef) -> bool:
        first = [f for f in node.body if getattr(f, "name", "") in ("__init__", "__post_init__")]
        return any(self._call_acts(n) for f in first for n in ast.walk(f))


def _cannot_fail(statement: ast.stmt) -> bool:
    """True for a statement after which the next one runs for certain."""
    match statement:
        case ast.Pass() | ast.Global() | ast.Nonlocal() | ast.Expr(ast.Constant()):
            return True
        case ast.Assign(targets, ast.Constant()):
            return all(isinstance(t, ast.Name) for t in targets)
        case ast.FunctionDef(decorator_list=[], args=ast.arguments(defaults=[], kw_defaults=[])):
            return True
    return False
