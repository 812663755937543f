"""What the top level of a plan does: which function is its entry, which settings it makes."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Collection, Iterator

from vaso.errors import PlanError, UnsupportedPlanError
from vaso.plan.rewrite import VALUE

_ENTRIES = ("main", "plan", "run", "execute", "execute_plan", "run_plan")
_COMPOUND = (ast.For, ast.While, ast.If, ast.Try, ast.With, ast.Match)
_SCOPES = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)


class TopLevel:
    """The top level of a plan.

    Args:
        tree: The plan.
        name: How messages call it.
        known: Functions that the plan may call without defining them.
    """

    def __init__(self, tree: ast.Module, name: str, known: Collection[str]) -> None:
        self._body = tree.body
        self._tree = tree
        self._name = name
        self._known = known
        self._functions = [n for n in tree.body if isinstance(n, ast.FunctionDef)]
        self._classes = [n for n in tree.body if isinstance(n, ast.ClassDef)]
        variables = {name for s in tree.body for name in _stored(s)}
        functions = {f.name for f in self._functions}
        self._acting = {*known, *functions, *(variables - set(dir(builtins)))}
        self._acting |= {c.name for c in self._classes if self._constructor_acts(c)}
        self._methods = {m.name for c in self._classes for m in _methods(c)}

    def entry_call(self) -> str:
        """A call of the entry function, for a module that only defines functions.

        Raises:
            PlanError: The entry function needs arguments.
        """
        rest = [n for n in self._body if not isinstance(n, (ast.FunctionDef, ast.ClassDef))]
        if not self._functions or any(self._acts(n) or _builds_list(n) for n in rest):
            return ""
        last = self._functions[-1]
        entry = next((f for f in reversed(self._functions) if f.name in _ENTRIES), last)
        needed = len(entry.args.posonlyargs + entry.args.args) - len(entry.args.defaults)
        if needed > 0 or None in entry.args.kw_defaults:
            raise PlanError(
                f"the plan's entry function '{entry.name}' needs arguments",
                source=self._name,
                line=entry.lineno,
                expected="an entry function whose parameters all have defaults, or a script",
            )
        return f"{VALUE} = {entry.name}()\n"

    def settings(self, constants: Collection[str]) -> dict[str, object]:
        """Constants of the labelling code that the plan sets for its whole run.

        Args:
            constants: Constants that the labelling code's functions read.

        Raises:
            UnsupportedPlanError: The plan sets one later, again, or to what is not a literal, so
                that its value would change while the plan runs.
        """
        found: dict[str, object] = {}
        started = False
        shared = set(constants) - self._own_variables()
        for statement in self._body:
            for line, name in bindings(statement):
                if name in shared:
                    value = _setting(statement)
                    if started or name in found or value is None:
                        raise self._unsettled(name, line)
                    found[name] = ast.literal_eval(value)
            started = started or self._acts(statement)
        return found

    def _own_variables(self) -> set[str]:
        """Variables of a plan that brings its own version of the skill's functions.

        Models like to copy the labelling code into the plan. What such functions change is the
        plan's, and the labelling code does not see it.
        """
        if not any(f.name in self._known for f in self._functions):
            return set()
        changed = [n for f in self._functions for n in ast.walk(f) if isinstance(n, ast.Global)]
        return {name for statement in changed for name in statement.names}

    def _unsettled(self, name: str, line: int) -> UnsupportedPlanError:
        return UnsupportedPlanError(
            f"the plan changes '{name}', a constant that the labelling code reads",
            source=self._name,
            line=line,
            expected=f"one line '{name} = <number>' before the plan's first call",
            hint="if it is a variable of the plan's own, give it another name",
        )

    def _acts(self, node: ast.stmt) -> bool:
        """True for a statement that does something: calls a function, loops, branches."""
        if isinstance(node, _SCOPES):
            return False
        return isinstance(node, _COMPOUND) or any(map(self._call_acts, _inner(node)))

    def _call_acts(self, node: ast.AST) -> bool:
        if not isinstance(node, ast.Call):
            return False
        if isinstance(node.func, ast.Name):
            return node.func.id in self._acting
        if isinstance(node.func, ast.Attribute):
            return node.func.attr in self._methods
        return True

    def _constructor_acts(self, node: ast.ClassDef) -> bool:
        first = [m for m in _methods(node) if m.name in ("__init__", "__post_init__")]
        own = {m.name for m in _methods(node)}
        calls = [c.func for m in first for c in ast.walk(m) if isinstance(c, ast.Call)]
        return any(
            f.id in self._acting if isinstance(f, ast.Name) else getattr(f, "attr", "") in own
            for f in calls
        )


def _methods(node: ast.ClassDef) -> list[ast.FunctionDef]:
    return [m for m in node.body if isinstance(m, ast.FunctionDef)]


def _inner(node: ast.AST) -> Iterator[ast.AST]:
    """A node and what runs with it: not the bodies of the functions in it."""
    yield node
    for child in ast.iter_child_nodes(node) if not isinstance(node, _SCOPES) else ():
        yield from _inner(child)


def _stored(statement: ast.stmt) -> dict[str, int]:
    """The names that a statement assigns, with lines."""
    names = [n for n in _inner(statement) if isinstance(n, ast.Name)]
    return {n.id: n.lineno for n in names if isinstance(n.ctx, ast.Store)}


def bindings(statement: ast.stmt) -> Iterator[tuple[int, str]]:
    """The module's names that a statement binds, with lines (those of functions it defines too)."""
    yield from ((line, name) for name, line in _stored(statement).items())
    for node in _inner(statement):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            yield node.lineno, node.name
    for node in ast.walk(statement):
        if isinstance(node, ast.Global):
            yield from ((node.lineno, name) for name in node.names)


def _setting(statement: ast.stmt) -> ast.expr | None:
    """The literal that a statement assigns to plain names; None for any other statement."""
    if not isinstance(statement, (ast.Assign, ast.AnnAssign)) or statement.value is None:
        return None
    targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
    if not all(isinstance(t, ast.Name) for t in targets):
        return None
    try:
        ast.literal_eval(statement.value)
    except (ValueError, TypeError):
        return None
    return statement.value


def _builds_list(node: ast.stmt) -> bool:
    if isinstance(node, ast.AugAssign):
        return True
    value = getattr(node, "value", None)
    if isinstance(node, (ast.Assign, ast.AnnAssign)):
        return isinstance(value, (ast.List, ast.BinOp, ast.ListComp))
    return isinstance(node, ast.Expr) and isinstance(value, (ast.Call, ast.List, ast.Name))
