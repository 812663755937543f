"""Turn a plan's statements into steps (a control-flow graph).

Everything is built from its end: a function gets the number of the step that comes next and returns
the number of the first of its own steps.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass, replace

from vaso.plan.abstraction.expressions import Expressions
from vaso.plan.abstraction.fields import Fields
from vaso.plan.abstraction.flow import Enter, Graph, Set, Skip, Use
from vaso.plan.abstraction.forms import Affine, Var
from vaso.plan.abstraction.scopes import NotAnalysableError, Scope, Scopes, parameters


@dataclass(frozen=True, slots=True)
class _Context:
    """Where control goes from inside a function.

    Attributes:
        scope: The function.
        leave: The step after a ``return``.
        stop: The step after a ``break``.
        again: The step after a ``continue``.
    """

    scope: Scope
    leave: int
    stop: int | None = None
    again: int | None = None


class Lowering(Expressions):
    """Lowers a program.

    Args:
        text: The program.
        tree: The same, parsed.
        scopes: Its scopes.
        fields: Its classes with a single object.

    Raises:
        NotAnalysableError: It uses a construct that is not followed.
    """

    def __init__(self, text: str, tree: ast.Module, scopes: Scopes, fields: Fields) -> None:
        super().__init__(text, scopes, fields, Graph())
        end = self.graph.join()
        start = self._block(tree.body, end, _Context(self.scopes.module, end))
        self.graph.add(Skip(), start)
        while self.pending:
            number = self.pending.pop()
            self._shared(number)

    def body(self, number: int, leave: int) -> int:
        """A copy of a function's body; its first step."""
        node = self.scopes.functions[number]
        context = _Context(self.scopes.of[node], leave)
        if isinstance(node, ast.Lambda):
            first = self._returned(node.body, context)
        else:
            no_value = self.graph.add(Set(self.returned(number)), leave)
            first = self._block(node.body, no_value, context)
        return self.graph.add(Enter(number), first)

    def _shared(self, number: int) -> None:
        """The copy of a function for calls that have none of their own."""
        self.place = (number,)
        enter = self.body(number, self.exits[number])
        self.graph.link(self.entries[number], enter)
        unknown = enter
        for name in parameters(self.scopes.functions[number]):
            unknown = self.graph.add(Set((number, name)), unknown)
        self.graph.link(self.callbacks[number], unknown)

    def _returned(self, value: ast.expr | None, context: _Context) -> int:
        target = self.returned(context.scope.number)
        if value is None:
            return self.graph.add(Set(target), context.leave)
        temporary = self.temporary(context.scope)
        done = self.graph.add(Set(target, Affine.of(temporary)), context.leave)
        if context.scope.number in self.scopes.escaping:
            done = self.graph.add(Use(Affine.of(temporary)), done)  # whoever called it has it now
        return self.value(value, temporary, done, context.scope)

    # --- statements ------------------------------------------------------------------------------

    def _block(self, body: Sequence[ast.stmt], after: int, context: _Context) -> int:
        for statement in reversed(body):
            after = self._statement(statement, after, context)
        return after

    def _statement(self, node: ast.stmt, after: int, context: _Context) -> int:
        lower = getattr(self, f"_{type(node).__name__.lower()}", None)
        if lower is None:
            raise NotAnalysableError(f"'{type(node).__name__}' in line {node.lineno}")
        number = lower(node, after, context)
        assert isinstance(number, int)
        return number

    def _pass(self, node: ast.stmt, after: int, context: _Context) -> int:
        return after

    _global = _nonlocal = _pass

    def _functiondef(self, node: ast.FunctionDef, after: int, context: _Context) -> int:
        var = self.scopes.owner(node.name, context.scope)
        done = after if var is None else self.graph.add(Set(var), after)
        defaults = [*node.args.defaults, *filter(None, node.args.kw_defaults)]
        return self.looked_at(defaults, done, context.scope)

    def _classdef(self, node: ast.ClassDef, after: int, context: _Context) -> int:
        var, inner = self.scopes.owner(node.name, context.scope), self.scopes.of[node]
        done = after if var is None else self.graph.add(Set(var), after)
        body = [n for n in node.body if not isinstance(n, ast.FunctionDef)]
        methods = [n for n in node.body if isinstance(n, ast.FunctionDef)]
        defaults = [d for m in methods for d in (*m.args.defaults, *m.args.kw_defaults) if d]
        first = self.looked_at([*defaults, *node.decorator_list], done, context.scope)
        return self._block(body, first, replace(context, scope=inner))

    def _import(self, node: ast.Import | ast.ImportFrom, after: int, context: _Context) -> int:
        for alias in node.names:
            var = self.scopes.owner((alias.asname or alias.name).split(".")[0], context.scope)
            if var is not None:
                after = self.graph.add(Set(var), after)
        return after

    _importfrom = _import

    def _expr(self, node: ast.Expr, after: int, context: _Context) -> int:
        return self.ignored(node.value, after, context.scope)

    def _return(self, node: ast.Return, after: int, context: _Context) -> int:
        return self._returned(node.value, context)

    def _assign(self, node: ast.Assign, after: int, context: _Context) -> int:
        first, *_ = node.targets
        if len(node.targets) == 1 and _parallel(first, node.value):
            return self._unpacked(first, node.value, after, context)
        temporary = self.temporary(context.scope)
        for target in reversed(node.targets):
            after = self.stored(target, temporary, after, context.scope)
        return self.value(node.value, temporary, after, context.scope)

    def _unpacked(self, target: ast.expr, value: ast.expr, after: int, context: _Context) -> int:
        """``a, b = x, y``, value by value."""
        assert isinstance(target, (ast.Tuple, ast.List)) and isinstance(value, ast.Tuple | ast.List)
        temporaries = [self.temporary(context.scope) for _ in value.elts]
        for part, temporary in reversed(list(zip(target.elts, temporaries, strict=True))):
            after = self.stored(part, temporary, after, context.scope)
        for part, temporary in reversed(list(zip(value.elts, temporaries, strict=True))):
            after = self.value(part, temporary, after, context.scope)
        return after

    def _annassign(self, node: ast.AnnAssign, after: int, context: _Context) -> int:
        if node.value is None:
            return after
        temporary = self.temporary(context.scope)
        after = self.stored(node.target, temporary, after, context.scope)
        return self.value(node.value, temporary, after, context.scope)

    def _augassign(self, node: ast.AugAssign, after: int, context: _Context) -> int:
        temporary = self.temporary(context.scope)
        after = self.stored(node.target, temporary, after, context.scope)
        current = self.temporary(context.scope)
        added = self.temporary(context.scope)
        after = self.computed(node, (current, added), temporary, after)
        after = self.value(node.value, added, after, context.scope)
        return self.value(_loaded(node.target), current, after, context.scope)

    def _if(self, node: ast.If, after: int, context: _Context) -> int:
        yes = self._block(node.body, after, context)
        no = self._block(node.orelse, after, context)
        return self.condition(node.test, yes, no, context.scope)

    def _while(self, node: ast.While, after: int, context: _Context) -> int:
        head = self.graph.join()
        inside = replace(context, stop=after, again=head)
        body = self._block(node.body, head, inside)
        done = self._block(node.orelse, after, context)
        self.graph.link(head, self.condition(node.test, body, done, context.scope))
        return head

    def _for(self, node: ast.For, after: int, context: _Context) -> int:
        head, element = self.graph.join(), self.temporary(context.scope)
        inside = replace(context, stop=after, again=head)
        body = self._block(node.body, head, inside)
        bind = self.stored(node.target, element, body, context.scope)
        fetch = self.graph.add(Set(element), bind)
        self.graph.link(head, fetch, self._block(node.orelse, after, context))
        start = self.may_call(self.scopes.loose, head, context.scope)
        return self.looked_at([node.iter], start, context.scope)

    def _break(self, node: ast.Break, after: int, context: _Context) -> int:
        assert context.stop is not None
        return context.stop

    def _continue(self, node: ast.Continue, after: int, context: _Context) -> int:
        assert context.again is not None
        return context.again

    def _raise(self, node: ast.Raise, after: int, context: _Context) -> int:
        # Handlers follow every step; without one the plan ends.
        parts = [p for p in (node.exc, node.cause) if p is not None]
        return self.looked_at(parts, self.graph.join(), context.scope)

    def _assert(self, node: ast.Assert, after: int, context: _Context) -> int:
        parts = [node.msg] if node.msg else []
        failed = self.looked_at(parts, self.graph.join(), context.scope)
        return self.condition(node.test, after, failed, context.scope)

    def _try(self, node: ast.Try, after: int, context: _Context) -> int:
        """Handlers and ``finally`` may follow any step of the program; that is coarse and safe."""
        if node.finalbody:
            end = self.graph.join()
            final = self._block(node.finalbody, end, context)
            ways = [after, context.leave, context.stop, context.again]
            self.graph.link(end, *(w for w in ways if w is not None))
            self.graph.handlers.append(final)
            inside = replace(
                context,
                leave=final,
                stop=None if context.stop is None else final,
                again=None if context.again is None else final,
            )
            after = final
        else:
            inside = context
        for handler in node.handlers:
            first = self._block(handler.body, after, inside)
            var = self.scopes.owner(handler.name, context.scope) if handler.name else None
            first = first if var is None else self.graph.add(Set(var), first)
            self.graph.handlers.append(first)
        done = self._block(node.orelse, after, inside)
        return self._block(node.body, done, inside)

    def _match(self, node: ast.Match, after: int, context: _Context) -> int:
        other = after
        for case in reversed(node.cases):
            body = self._block(case.body, after, context)
            if case.guard is not None:
                body = self.condition(case.guard, body, other, context.scope)
            for var in self._captures(case.pattern, context.scope):
                body = self.graph.add(Set(var), body)
            values = [p.value for p in ast.walk(case.pattern) if isinstance(p, ast.MatchValue)]
            choice = self.graph.join()
            self.graph.link(choice, body, other)
            other = self.looked_at(values, choice, context.scope)
        return self.looked_at([node.subject], other, context.scope)

    def _captures(self, pattern: ast.pattern, scope: Scope) -> list[Var]:
        parts = [p for p in ast.walk(pattern) if isinstance(p, ast.MatchAs | ast.MatchStar)]
        rest = [p.rest for p in ast.walk(pattern) if isinstance(p, ast.MatchMapping) and p.rest]
        names = [p.name for p in parts if p.name] + rest
        found = (self.scopes.owner(name, scope) for name in names)
        return [var for var in found if var is not None]


def _parallel(target: ast.expr, value: ast.expr) -> bool:
    sequences = (ast.Tuple, ast.List)
    if not isinstance(target, sequences) or not isinstance(value, sequences):
        return False
    starred = any(isinstance(e, ast.Starred) for e in (*target.elts, *value.elts))
    return len(target.elts) == len(value.elts) and not starred


def _loaded(target: ast.expr) -> ast.expr:
    """The target of ``x += 1`` as an expression."""
    if isinstance(target, ast.Name):
        return ast.copy_location(ast.Name(target.id, ast.Load()), target)
    if isinstance(target, ast.Attribute):
        return ast.copy_location(ast.Attribute(target.value, target.attr, ast.Load()), target)
    assert isinstance(target, ast.Subscript)
    return ast.copy_location(ast.Subscript(target.value, target.slice, ast.Load()), target)
