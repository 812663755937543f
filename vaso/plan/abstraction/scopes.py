"""Who owns a plan's variables, which functions there are, and what a call may call."""

from __future__ import annotations

import ast
import builtins
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import TypeAlias, TypeGuard

from vaso.plan.abstraction.forms import GLOBAL, Var
from vaso.plan.nodes import nodes

Function: TypeAlias = ast.FunctionDef | ast.Lambda
Comprehension: TypeAlias = ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp
COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)

_REFUSED_NAMES = frozenset(
    {"eval", "exec", "compile", "globals", "locals", "vars", "getattr", "setattr", "delattr"}
)
_REFUSED = (
    ast.AsyncFunctionDef, ast.Await, ast.AsyncFor, ast.AsyncWith, ast.Yield, ast.YieldFrom,
    ast.With, ast.Delete, ast.TryStar, ast.NamedExpr,
)  # fmt: skip
CONSTRUCTORS = frozenset({"__init__", "__post_init__"})


class NotAnalysableError(Exception):
    """The plan uses something that this analysis does not follow; its states are kept apart."""


@dataclass(slots=True)
class Scope:
    """The module, a function, or (hidden) a comprehension or the body of a class.

    Attributes:
        number: The number of the function whose variables these are; ``GLOBAL`` for the module.
        parent: The scope in which names are looked up next.
        hidden: True if its own names are no variables of the program's.
        own: Names that it binds.
        elsewhere: Names that it declares ``global`` or ``nonlocal``.
    """

    number: int
    parent: Scope | None = None
    hidden: bool = False
    own: set[str] = field(default_factory=set)
    elsewhere: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _Use:
    """A name that is read; ``called`` if only its being called is of interest."""

    name: str
    scope: Scope
    called: bool


class Scopes:
    """The scopes of a program.

    Args:
        tree: The program.

    Attributes:
        module: The module's scope.
        functions: Every function, method and lambda, in the order of the text.
        of: The scope of each function, comprehension and class.
        loose: Numbers of the functions that are passed about as values.
        methods: Numbers of the methods with a name.
        escaping: Numbers of all the functions that a call may call whose callee is not certain.
        loggers: Variables that can only be ``logging.getLogger(…)``.
        untracked: Variables whose values are always kept as they are.

    Raises:
        NotAnalysableError: It uses a construct that is not followed.
    """

    def __init__(self, tree: ast.Module) -> None:
        _refuse(tree)
        self.module = Scope(GLOBAL)
        self.functions: list[Function] = []
        self.of: dict[ast.AST, Scope] = {tree: self.module}
        self.loose: set[int] = set()
        self.escaping: set[int] = set()
        self.methods: dict[str, set[int]] = {}
        self.untracked: set[Var] = set()
        self.loggers: set[Var] = set()
        self._stores: list[tuple[str, Scope, ast.AST]] = []
        self._uses: list[_Use] = []
        self._attributes: set[str] = set()
        self._bindings: dict[Var, list[ast.AST]] = defaultdict(list)
        for statement in tree.body:
            self._visit(statement, self.module)
        for name, scope, _ in self._stores:
            if name not in scope.elsewhere:
                scope.own.add(name)
            elif scope.elsewhere[name] == "global":
                self.module.own.add(name)
        for name, scope, node in self._stores:
            if (var := self.owner(name, scope)) is not None:
                self._bindings[var].append(node)
        self._find_loose()
        made = {id(n.targets[0]) for n in nodes(tree) if _makes_logger(n)}
        for var, ways in self._bindings.items():
            if all(id(way) in made for way in ways):
                self.loggers.add(var)

    def variables(self) -> Iterable[Var]:
        """Every variable."""
        return self._bindings

    def calling(self, func: ast.expr, scope: Scope) -> set[int]:
        """The functions that a call may call whose callee is not certain."""
        if isinstance(func, ast.Attribute):
            return self.loose | self.methods.get(func.attr, set())
        if isinstance(func, ast.Name) and self.external(func.id, scope):
            return set()
        created = {n for name in CONSTRUCTORS for n in self.methods.get(name, set())}
        return self.loose | created

    def owner(self, name: str, scope: Scope) -> Var | None:
        """The variable that a name means; None for one that is no variable of the program's."""
        here: Scope | None = scope
        while here is not None:
            if here.elsewhere.get(name) == "global":
                here = self.module
            if name in here.own:
                return None if here.hidden else (here.number, name)
            here = here.parent
        return None

    def hidden(self, name: str, scope: Scope) -> bool:
        """True for a variable of a comprehension or a class."""
        here: Scope | None = scope
        while here is not None and here.hidden:
            if name in here.own:
                return True
            here = here.parent
        return False

    def bindings(self, var: Var) -> list[ast.AST]:
        """Where a variable is bound."""
        return self._bindings[var]

    def called(self, func: ast.expr, scope: Scope) -> int | None:
        """The number of the function that a callee certainly is."""
        var = self.owner(func.id, scope) if isinstance(func, ast.Name) else None
        ways = self.bindings(var) if var is not None else []
        if len(ways) == 1 and isinstance(ways[0], ast.FunctionDef):
            return self.of[ways[0]].number
        return None

    def external(self, name: str, scope: Scope) -> bool:
        """True for a name that neither the program nor Python defines."""
        known = self.owner(name, scope) is not None or self.hidden(name, scope)
        return not known and not hasattr(builtins, name)

    # --- collecting ------------------------------------------------------------------------------

    def _visit(self, node: ast.AST, scope: Scope) -> None:
        if isinstance(node, (ast.FunctionDef, ast.Lambda)):
            self._function(node, scope)
        elif isinstance(node, ast.ClassDef):
            self._class(node, scope)
        elif isinstance(node, COMPREHENSIONS):
            self._comprehension(node, scope)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            self._uses.append(_Use(node.func.id, scope, True))
            self._each([*node.args, *node.keywords], scope)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            self._each([node.func.value, *node.args, *node.keywords], scope)
        elif isinstance(node, (ast.Global, ast.Nonlocal)):
            kind = "global" if isinstance(node, ast.Global) else "nonlocal"
            scope.elsewhere.update(dict.fromkeys(node.names, kind))
        else:
            self._stores += [(name, scope, node) for name in _bound(node)]
            if isinstance(node, ast.Attribute):
                self._attributes.add(node.attr)
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
                self._uses.append(_Use(node.id, scope, False))
            self._each(ast.iter_child_nodes(node), scope)

    def _each(self, nodes: Iterator[ast.AST] | list[ast.AST], scope: Scope) -> None:
        for node in nodes:
            self._visit(node, scope)

    def _function(self, node: Function, scope: Scope, outer: Scope | None = None) -> None:
        inner = self.of[node] = Scope(len(self.functions), outer or scope)
        self.functions.append(node)
        arguments = node.args
        defaults: list[ast.AST] = [*arguments.defaults, *filter(None, arguments.kw_defaults)]
        self._each(defaults, scope)
        self._stores += [(name, inner, node.args) for name in parameters(node)]
        if isinstance(node, ast.FunctionDef):
            self._stores.append((node.name, scope, node))
            self._each(list(node.body), inner)
        else:
            self.loose.add(inner.number)
            self._visit(node.body, inner)

    def _class(self, node: ast.ClassDef, scope: Scope) -> None:
        self._stores.append((node.name, scope, node))
        body = self.of[node] = Scope(scope.number, scope, hidden=True)
        self._each([*node.bases, *node.keywords, *node.decorator_list], scope)
        for statement in node.body:
            if isinstance(statement, ast.FunctionDef):
                if statement.name.startswith("__") and statement.name not in CONSTRUCTORS:
                    raise NotAnalysableError("a class with operators of its own")
                self._function(statement, body, outer=scope)
                numbers = self.methods.setdefault(statement.name, set())
                numbers.add(self.of[statement].number)
            else:
                self._visit(statement, body)

    def _comprehension(self, node: Comprehension, scope: Scope) -> None:
        inner = self.of[node] = Scope(scope.number, scope, hidden=True)
        self._visit(node.generators[0].iter, scope)
        for part in ast.iter_child_nodes(node):
            if isinstance(part, ast.comprehension):
                later = [] if part is node.generators[0] else [part.iter]
                self._each([part.target, *later, *part.ifs], inner)
            else:
                self._visit(part, inner)

    # --- who may be called, and what is followed -------------------------------------------------

    def _find_loose(self) -> None:
        for use in self._uses:
            var = self.owner(use.name, use.scope)
            ways = self.bindings(var) if var is not None else []
            sure = use.called and self.called(ast.Name(use.name, ast.Load()), use.scope) is not None
            if not sure:
                self.loose |= {self.of[w].number for w in ways if isinstance(w, ast.FunctionDef)}
                self.loose |= {self.of[m].number for w in ways for m in _constructors(w)}
        for name in self._attributes & set(self.methods):
            self.loose |= self.methods[name]
        self.escaping = self.loose.union(*self.methods.values())

    def only_called(self, method: str) -> None:
        """Note that a method is only called where it is certain which one it is."""
        self.methods.pop(method)
        self.escaping = self.loose.union(*self.methods.values())

    def find_untracked(self) -> None:
        """A variable whose owner may have ended, or may run twice, when a function uses it."""
        for name, scope in [*((u.name, u.scope) for u in self._uses), *self._written()]:
            var, here = self.owner(name, scope), scope
            while var is not None and here.number != var[0] and here.parent is not None:
                if here.number in self.escaping and var[0] != GLOBAL:
                    self.untracked.add(var)
                here = here.parent

    def _written(self) -> Iterator[tuple[str, Scope]]:
        return ((name, scope) for name, scope, _ in self._stores)


def parameters(node: Function) -> list[str]:
    """The names of a function's parameters, in the order in which a call fills them."""
    given = node.args
    extra = [a for a in (given.vararg, given.kwarg) if a is not None]
    return [a.arg for a in (*given.posonlyargs, *given.args, *given.kwonlyargs, *extra)]


def _constructors(node: ast.AST) -> list[ast.FunctionDef]:
    """What runs when a class that is passed about as a value is called."""
    body = node.body if isinstance(node, ast.ClassDef) else []
    return [m for m in body if isinstance(m, ast.FunctionDef) and m.name in CONSTRUCTORS]


def _bound(node: ast.AST) -> list[str]:
    """The names that a node binds by itself."""
    if isinstance(node, ast.Name):
        return [] if isinstance(node.ctx, ast.Load) else [node.id]
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        return [(a.asname or a.name).split(".")[0] for a in node.names]
    if isinstance(node, ast.ExceptHandler | ast.MatchAs | ast.MatchStar):
        return [node.name] if node.name else []
    if isinstance(node, ast.MatchMapping):
        return [node.rest] if node.rest else []
    return []


def _makes_logger(node: ast.AST) -> TypeGuard[ast.Assign]:
    if not isinstance(node, ast.Assign) or not isinstance(node.value, ast.Call):
        return False
    return isinstance(node.value.func, ast.Attribute) and node.value.func.attr == "getLogger"


def _refuse(tree: ast.Module) -> None:
    for node in nodes(tree):
        if isinstance(node, _REFUSED):
            line = getattr(node, "lineno", 0)
            raise NotAnalysableError(f"'{type(node).__name__}' in line {line}")
        if isinstance(node, ast.Name) and node.id in _REFUSED_NAMES:
            raise NotAnalysableError(f"'{node.id}' in line {node.lineno}")
        if isinstance(node, ast.FunctionDef) and node.decorator_list:
            raise NotAnalysableError(f"a decorator in line {node.lineno}")
        if isinstance(node, ast.ImportFrom) and any(a.name == "*" for a in node.names):
            raise NotAnalysableError(f"'import *' in line {node.lineno}")
