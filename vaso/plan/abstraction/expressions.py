"""Turn a plan's expressions into steps: evaluated from left to right, into temporaries."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import TypeGuard

from vaso.plan.abstraction.calls import Calls, constant
from vaso.plan.abstraction.flow import ONE, Set, Use
from vaso.plan.abstraction.forms import Affine, Var
from vaso.plan.abstraction.scopes import COMPREHENSIONS, Comprehension, Scope

_MESSAGES = frozenset({"debug", "info", "warning", "error", "critical", "exception"})
_SHOWN = frozenset({"round", "str", "int", "float", "format", "repr", "abs", "len"})
"""Functions that cannot fail because of a number's value (with arguments that are numbers)."""


class Expressions(Calls):
    """Lowers expressions."""

    # --- values ----------------------------------------------------------------------------------

    def value(self, node: ast.expr, into: Var, after: int, scope: Scope) -> int:
        """Evaluate an expression into a variable."""
        if isinstance(node, ast.Constant):
            number = isinstance(node.value, (int, float)) and not isinstance(node.value, bool)
            nothing = node.value is None
            return self.graph.add(Set(into, constant(node.value), not number, nothing), after)
        if isinstance(node, ast.Name):
            return self._load(node.id, into, after, scope)
        if (var := self.fields.variable(node, scope)) is not None:
            return self._read(var, into, after)
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
            return self.call(node, into, after, scope)
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
            # Another width may raise an exception.
            widths = [s for v in shown if (s := v.format_spec) is not None]
            after = self.looked_at(widths, after, scope)
            return self._all_ignored([v.value for v in shown], after, scope)
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
            if name in _SHOWN and plain and not own and (name != "int" or len(node.args) == 1):
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
        if var is None or var in self.scopes.untracked:
            return self.graph.add(Set(into), after)
        return self._read(var, into, after)

    def _read(self, var: Var, into: Var, after: int) -> int:
        """A variable that has no value, or none that one can compute with, fails here or later."""
        return self.graph.add(
            Use(Affine.of(var), "kind"), self.graph.add(Set(into, Affine.of(var)), after)
        )

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
        if isinstance(node.op, (ast.Mod, ast.FloorDiv)) and _is_divisor(_right(node)):
            # No number fails here, so nobody need know it who does not look at the result.
            done = self.graph.add(Set(into, parts=(sides[0],)), after)
            return self.graph.add(Use(one, "kind"), done)
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
            sides = [node.left, *node.comparators][index : index + 2]
            test = self._compared(node.ops[index], pair, choice, any(map(_is_singleton, sides)))
            following = self.value(node.comparators[index], held[index + 1], test, scope)
        return self.value(node.left, held[0], following, scope)

    def _compared(self, op: ast.cmpop, pair: tuple[Var, Var], after: int, singleton: bool) -> int:
        """Compare two values; ``singleton`` if one of them is None, True or False."""
        one, two = (Affine.of(var) for var in pair)
        if isinstance(op, (ast.Is, ast.IsNot)) and singleton:
            after = self.graph.add(Use(two, "kind"), after)
            return self.graph.add(Use(one, "kind"), after)
        if isinstance(op, (ast.In, ast.NotIn, ast.Is, ast.IsNot)):
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


def _is_format(node: ast.expr) -> TypeGuard[ast.Call]:
    """``"…".format(…)`` without keywords, and without widths that are values."""
    return (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "format"
        and isinstance(node.func.value, ast.Constant)
        and not re.search(r"\{[^{}]*\{", str(node.func.value.value))
        and not node.keywords
        and not any(isinstance(a, ast.Starred) for a in node.args)
    )


def _right(node: ast.BinOp | ast.AugAssign) -> ast.expr:
    return node.right if isinstance(node, ast.BinOp) else node.value


def _is_singleton(node: ast.expr) -> bool:
    """None, True or False, which no number is."""
    return isinstance(node, ast.Constant) and (node.value is None or isinstance(node.value, bool))


def _is_divisor(node: ast.expr) -> bool:
    """True for a literal whole number by which every number can be divided."""
    value = node.value if isinstance(node, ast.Constant) else None
    return type(value) is int and 0 < value < 2**53


def _number(node: ast.expr | None) -> Fraction | None:
    """The value of a literal number."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        inner = _number(node.operand)
        return None if inner is None else -inner
    found = constant(node.value) if isinstance(node, ast.Constant) else None
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
