"""Attributes and methods of classes with a single object: as good as variables and functions.

Models like to keep the time in ``self.start``. Where a class has one object at most, ``self.start``
means one variable, whoever reads it.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

from vaso.plan.abstraction.forms import GLOBAL, Var
from vaso.plan.abstraction.scopes import COMPREHENSIONS, Scope, Scopes, parameters
from vaso.plan.nodes import nodes

FIRST = -10
"""Number of the first class, as an owner of variables; the next one's is one less."""

_LOOPS = (ast.For, ast.While, *COMPREHENSIONS)
_BUILT_IN = {n for kind in (list, dict, set, tuple, str, float, int, bytes) for n in dir(kind)}
_BUILT_IN |= {"popleft", "appendleft", "rotate", "extendleft"}


@dataclass(frozen=True, slots=True)
class Single:
    """A class with one object at most.

    Attributes:
        number: Its number, as an owner of variables.
        node: Its definition.
        methods: The functions of its methods.
        fields: Attributes that are variables.
        certain: Methods that nothing but a call by name reaches.
    """

    number: int
    node: ast.ClassDef
    methods: dict[str, ast.FunctionDef]
    fields: set[str] = field(default_factory=set)
    certain: set[str] = field(default_factory=set)


class Fields:
    """The classes of a program that have a single object.

    Args:
        tree: The program.
        scopes: Its scopes; methods that are only called by name are taken off their lists.
    """

    def __init__(self, tree: ast.Module, scopes: Scopes) -> None:
        self._scopes = scopes
        self._parents = {c: n for n in nodes(tree) for c in ast.iter_child_nodes(n)}
        self._scope_of: dict[ast.AST, Scope] = {}
        self._place(tree, scopes.module)
        self._made = {
            id(n.targets[0]): n.value
            for n in nodes(tree)
            if isinstance(n, ast.Assign) and len(n.targets) == 1 and isinstance(n.value, ast.Call)
        }
        self._attributes = [n for n in nodes(tree) if isinstance(n, ast.Attribute)]
        self._names = [n for n in nodes(tree) if isinstance(n, ast.Name)]
        self.classes: list[Single] = []
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and self._is_single(node):
                methods = {m.name: m for m in node.body if isinstance(m, ast.FunctionDef)}
                self.classes.append(Single(FIRST - len(self.classes), node, methods))
        for single in self.classes:
            self._find_fields(single)
            self._find_methods(single)

    def variable(self, node: ast.expr, scope: Scope) -> Var | None:
        """The variable that an attribute is."""
        if not isinstance(node, ast.Attribute):
            return None
        single = self._receiver(node.value, scope)
        return (single.number, node.attr) if single and node.attr in single.fields else None

    def method(self, func: ast.expr, scope: Scope) -> int | None:
        """The number of the method that a callee certainly is."""
        if not isinstance(func, ast.Attribute):
            return None
        single = self._receiver(func.value, scope)
        if single is None or func.attr not in single.certain:
            return None
        return self._scopes.of[single.methods[func.attr]].number

    # --- one object at most ----------------------------------------------------------------------

    def _is_single(self, node: ast.ClassDef) -> bool:
        if node.bases or node.keywords or node.decorator_list:
            return False
        if self._scopes.bindings((GLOBAL, node.name)) != [node]:
            return False
        uses = [n for n in self._uses(node.name) if not self._in_annotation(n)]
        if len(uses) != 1:
            return False
        call = self._parents.get(uses[0])
        return isinstance(call, ast.Call) and call.func is uses[0] and self._runs_once(call)

    def _uses(self, name: str) -> list[ast.Name]:
        return [n for n in self._names if n.id == name]

    def _in_annotation(self, node: ast.AST) -> bool:
        parent = self._parents.get(node)
        while parent is not None:
            notes = (getattr(parent, "annotation", None), getattr(parent, "returns", None))
            if node in notes:
                return True
            node, parent = parent, self._parents.get(parent)
        return False

    def _runs_once(self, node: ast.AST) -> bool:
        """True if a node runs once at most."""
        here: ast.AST | None = node
        while here is not None and not isinstance(here, (ast.FunctionDef, ast.Lambda)):
            if isinstance(here, (*_LOOPS, ast.ClassDef)):
                return False
            here = self._parents.get(here)
        if here is None:
            return True
        number = self._scopes.of[here].number
        if isinstance(here, ast.Lambda) or number in self._scopes.escaping:
            return False
        calls = [
            parent
            for use in self._uses(here.name)
            if isinstance(parent := self._parents.get(use), ast.Call)
            and self._scopes.called(use, self._scope_of[use]) == number
        ]
        # A function that its own body calls is called twice in the text.
        return len(calls) == 1 and self._runs_once(calls[0])

    # --- what is a variable, what is a function --------------------------------------------------

    def _receiver(self, node: ast.expr, scope: Scope) -> Single | None:
        """The class of a receiver that is certainly its object."""
        if isinstance(node, ast.Call):
            return self._called(node)
        var = self._scopes.owner(node.id, scope) if isinstance(node, ast.Name) else None
        ways = self._scopes.bindings(var) if var is not None else []
        if var is None or len(ways) != 1:
            return None
        if (made := self._made.get(id(ways[0]))) is not None:
            return self._called(made)
        for single in self.classes:
            for method in single.methods.values():
                own = self._scopes.of[method].number == var[0]
                if own and ways[0] is method.args and parameters(method)[:1] == [var[1]]:
                    return single
        return None

    def _called(self, node: ast.Call) -> Single | None:
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        return next((s for s in self.classes if s.node.name == name), None)

    def _find_fields(self, single: Single) -> None:
        in_classes = {
            name
            for node in self._parents
            if isinstance(node, ast.ClassDef)
            for part in node.body
            for name in _bound_in_class(part)
        }
        known, unknown = Counter[str](), Counter[str]()
        for node in self._attributes:
            mine = self._receiver(node.value, self._scope_of[node]) is single
            (known if mine else unknown)[node.attr] += 1
        single.fields.update(set(known) - set(unknown) - in_classes)

    def _find_methods(self, single: Single) -> None:
        for name, function in single.methods.items():
            number = self._scopes.of[function].number
            uses = [n for n in self._attributes if n.attr == name]
            certain = all(
                self._receiver(n.value, self._scope_of[n]) is single
                and isinstance(call := self._parents[n], ast.Call)
                and call.func is n
                for n in uses
            )
            plain = not name.startswith("__") and name not in _BUILT_IN
            if certain and plain and self._scopes.methods[name] == {number}:
                single.certain.add(name)
                self._scopes.only_called(name)

    def _place(self, node: ast.AST, scope: Scope) -> None:
        """Note the scope of every node."""
        for child in ast.iter_child_nodes(node):
            self._scope_of[child] = scope
            self._place(child, self._scopes.of.get(child, scope))


def _bound_in_class(node: ast.stmt) -> Iterator[str]:
    """The names that a statement of a class's body binds."""
    if isinstance(node, ast.FunctionDef):
        yield node.name
        return
    for part in ast.walk(node):
        if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store):
            yield part.id
