"""The expressions of the symbolic interpreter."""

from __future__ import annotations

import ast
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any

import z3

from vaso.labels.symbolic.history import History, Tail
from vaso.labels.symbolic.mathematics import MATH, binary, negative
from vaso.labels.symbolic.paths import Path
from vaso.labels.symbolic.standard import CALLABLE
from vaso.labels.symbolic.values import (
    Bound,
    Class,
    Function,
    NotUnderstoodError,
    Poison,
    PythonError,
    Record,
    Value,
    compare,
    is_symbolic,
    is_term,
    number,
    real,
)

__all__ = ["Expressions", "Module"]


class Module:
    """The module ``math``."""


class Expressions(ABC):
    """Evaluates expressions; statements are in :mod:`vaso.labels.symbolic.interpreter`."""

    path: Path

    @abstractmethod
    def call(self, function: Function, args: list[Value], kwargs: dict[str, Value]) -> Value:
        """Call a function."""

    @abstractmethod
    def read(self, name: str) -> Value:
        """The value of a name."""

    @abstractmethod
    def assign(self, target: ast.expr, value: Value) -> None:
        """Bind a target."""

    @abstractmethod
    def items(self, value: Value) -> list[Value]:
        """The items of something that can be gone through."""

    @abstractmethod
    def change(self, owner: Value) -> None:
        """Note that an object is changed."""

    @property
    @abstractmethod
    def names(self) -> Any:
        """Finds global names."""

    @property
    @abstractmethod
    def locals(self) -> dict[str, Value]:
        """The variables of the function that runs."""

    @property
    @abstractmethod
    def outer(self) -> dict[str, Value]:
        """The variables that a function defined here sees."""

    def value(self, node: ast.expr) -> Value:
        """The value of an expression."""
        run: Callable[[Any], Value] | None = getattr(self, f"_of_{type(node).__name__}", None)
        if run is None:
            raise NotUnderstoodError(f"the expression {type(node).__name__}")
        return run(node)

    def truth(self, value: Value) -> Value:
        """The truth value of a value."""
        if isinstance(value, z3.BoolRef) or (not is_term(value) and isinstance(value, bool)):
            return value
        if is_term(value):
            return real(value) != 0
        if isinstance(value, History):
            return True
        if isinstance(value, Tail | Record | Bound | Class | Function | Module):
            raise NotUnderstoodError("the truth of an object")
        return bool(value)

    # -- simple ones -------------------------------------------------------------------------------

    def _of_Constant(self, node: ast.Constant) -> Value:
        if not isinstance(node.value, bool | int | float | str | None):
            raise NotUnderstoodError("a constant of an unusual type")
        return node.value

    def _of_Name(self, node: ast.Name) -> Value:
        return self.read(node.id)

    def _of_Tuple(self, node: ast.Tuple) -> Value:
        return tuple(self._sequence(node.elts))

    def _of_List(self, node: ast.List) -> Value:
        return self._sequence(node.elts)

    def _sequence(self, elements: Sequence[ast.expr]) -> list[Value]:
        found: list[Value] = []
        for element in elements:
            if isinstance(element, ast.Starred):
                found += self.items(self.value(element.value))
            else:
                found.append(self.value(element))
        return found

    def _of_Dict(self, node: ast.Dict) -> Value:
        keys = [self.value(k) if k is not None else None for k in node.keys]
        if any(not isinstance(k, str | int | float | bool) for k in keys):
            raise NotUnderstoodError("a dictionary with unusual keys")
        return dict(zip(keys, map(self.value, node.values), strict=True))

    def _of_JoinedStr(self, node: ast.JoinedStr) -> Value:
        return Poison("a text that is put together")

    def _of_Lambda(self, node: ast.Lambda) -> Value:
        if node.args.defaults:
            raise NotUnderstoodError("a lambda with defaults")
        return Function(node, self.outer, self.names)

    def _of_IfExp(self, node: ast.IfExp) -> Value:
        taken = self.path.decide(self.truth(self.value(node.test)))
        return self.value(node.body if taken else node.orelse)

    def _of_NamedExpr(self, node: ast.NamedExpr) -> Value:
        value = self.value(node.value)
        self.assign(node.target, value)
        return value

    # -- operators ---------------------------------------------------------------------------------

    def _of_BinOp(self, node: ast.BinOp) -> Value:
        return binary(node.op, self.value(node.left), self.value(node.right), self.path)

    def _of_UnaryOp(self, node: ast.UnaryOp) -> Value:
        value = self.value(node.operand)
        match node.op:
            case ast.USub():
                return negative(value)
            case ast.UAdd():
                return number(value)
            case ast.Not():
                truth = self.truth(value)
                return z3.Not(truth) if is_term(truth) else not truth
        raise NotUnderstoodError("an operator on bits")

    def _of_BoolOp(self, node: ast.BoolOp) -> Value:
        value: Value = None
        for operand in node.values:
            value = self.value(operand)
            if operand is node.values[-1]:
                return value
            if self.path.decide(self.truth(value)) != isinstance(node.op, ast.And):
                break
        return value

    def _of_Compare(self, node: ast.Compare) -> Value:
        left = self.value(node.left)
        found: Value = True
        for op, operand in zip(node.ops, node.comparators, strict=True):
            right = self.value(operand)
            found = compare(op, left, right)
            if operand is node.comparators[-1]:
                return found
            if not self.path.decide(found):
                return False
            left = right
        return found

    # -- parts -------------------------------------------------------------------------------------

    def _of_Subscript(self, node: ast.Subscript) -> Value:
        owner = self.value(node.value)
        if isinstance(node.slice, ast.Slice):
            return self._slice(owner, node.slice)
        index = self.value(node.slice)
        if isinstance(owner, Tail):
            return owner.item(index)
        if isinstance(owner, Record):
            return self._call_method(owner, "__getitem__", [index], {})
        if is_symbolic(index) or not isinstance(owner, list | tuple | dict | str):
            raise NotUnderstoodError("an element of something that is not known")
        try:
            return owner[index]
        except (IndexError, KeyError, TypeError) as error:
            raise PythonError(f"{type(error).__name__}: {error}") from error

    def _slice(self, owner: Value, part: ast.Slice) -> Value:
        bounds = [self.value(n) if n is not None else None for n in (part.lower, part.upper)]
        if part.step is not None or any(b is not None and type(b) is not int for b in bounds):
            raise NotUnderstoodError("a part with unusual bounds")
        if isinstance(owner, History):
            return owner.slice(*bounds)
        if not isinstance(owner, list | tuple | str):
            raise NotUnderstoodError("a part of something that is not known")
        return owner[bounds[0] : bounds[1]]

    def _of_Attribute(self, node: ast.Attribute) -> Value:
        owner = self.value(node.value)
        if isinstance(owner, Module):
            import math

            if node.attr in MATH:
                return self.function_of_math(node.attr)
            constant = getattr(math, node.attr, None)
            if isinstance(constant, float):
                return constant
            raise NotUnderstoodError(f"math.{node.attr}")
        if isinstance(owner, Record):
            if node.attr in owner.fields:
                return self._known(owner.fields[node.attr])
            return Bound(lambda args, kwargs: self._call_method(owner, node.attr, args, kwargs))
        if isinstance(owner, Class):
            return Bound(lambda args, kwargs: self._call_static(owner, node.attr, args, kwargs))
        if isinstance(owner, list | Tail) and node.attr == "append":
            return Bound(lambda args, kwargs: self._append(owner, *args))
        if isinstance(owner, dict) and node.attr == "get" and not is_symbolic(list(owner)):
            return Bound(lambda args, kwargs: owner.get(*args))
        raise NotUnderstoodError(f"the attribute {node.attr}")

    def function_of_math(self, name: str) -> Bound:
        """A function of the module math."""
        return Bound(lambda args, kwargs: MATH[name](self.path, *args, **kwargs))

    def _known(self, value: Value) -> Value:
        if isinstance(value, Poison):
            raise NotUnderstoodError(value.why)
        return value

    def _append(self, owner: Any, value: Value) -> None:
        if isinstance(owner, History):
            raise NotUnderstoodError("set-points that are changed")
        self.change(owner)
        (owner if isinstance(owner, list) else owner.end).append(value)

    def _call_method(
        self, owner: Record, name: str, args: list[Value], kwargs: dict[str, Value]
    ) -> Value:
        method = owner.kind.methods.get(name)
        if method is None:
            raise NotUnderstoodError(f"the attribute {name}")
        if isinstance(method, Bound):
            return method.call([owner, *args], kwargs)
        if name in owner.kind.static:
            return self._call_static(owner.kind, name, args, kwargs)
        return self.call(method, [owner, *args], kwargs)

    def _call_static(
        self, owner: Class, name: str, args: list[Value], kwargs: dict[str, Value]
    ) -> Value:
        method = owner.methods.get(name)
        if method is None or name not in owner.static:
            raise NotUnderstoodError(f"the attribute {name} of a class")
        first = method.node.args.args[:1]
        by_class = bool(first) and first[0].arg == "cls"
        return self.call(method, [owner, *args] if by_class else args, kwargs)

    # -- calls -------------------------------------------------------------------------------------

    def _of_Call(self, node: ast.Call) -> Value:
        function = self.value(node.func)
        args = self._sequence(node.args)
        kwargs: dict[str, Value] = {}
        for keyword in node.keywords:
            if keyword.arg is None:
                raise NotUnderstoodError("arguments from a dictionary")
            kwargs[keyword.arg] = self.value(keyword.value)
        return self.apply(function, args, kwargs)

    def apply(self, function: Value, args: list[Value], kwargs: dict[str, Value]) -> Value:
        """Call whatever can be called."""
        if isinstance(function, Function):
            return self.call(function, args, kwargs)
        if isinstance(function, Bound):
            return function.call(args, kwargs)
        if isinstance(function, Class):
            return self._make(function, args, kwargs)
        if isinstance(function, str) and function in CALLABLE:
            return CALLABLE[function](self, *args, **kwargs)
        raise NotUnderstoodError("a call of something that is no function")

    def _make(self, kind: Class, args: list[Value], kwargs: dict[str, Value]) -> Record:
        made = Record(kind)
        if not kind.generated:
            if "__init__" in kind.methods:
                self.call(kind.methods["__init__"], [made, *args], kwargs)
            return made
        names = list(kind.fields)
        if len(args) > len(names) or not kwargs.keys() <= set(names):
            raise PythonError("TypeError: wrong arguments")
        given = dict(zip(names, args, strict=False)) | kwargs
        for name, default in kind.fields.items():
            if name not in given and isinstance(default, Poison):
                raise PythonError(f"TypeError: missing {name}")
            made.fields[name] = given.get(name, default)
        return made

    # -- comprehensions ----------------------------------------------------------------------------

    def _of_ListComp(self, node: ast.ListComp) -> Value:
        return self._comprehend(node)

    def _of_GeneratorExp(self, node: ast.GeneratorExp) -> Value:
        return self._comprehend(node)

    def _comprehend(self, node: ast.ListComp | ast.GeneratorExp) -> list[Value]:
        if len(node.generators) != 1 or node.generators[0].is_async:
            raise NotUnderstoodError("a comprehension over several lists")
        generator, found = node.generators[0], []
        before = dict(self.locals)
        for item in self.items(self.value(generator.iter)):
            self.assign(generator.target, item)
            if all(self.path.decide(self.truth(self.value(c))) for c in generator.ifs):
                found.append(self.value(node.elt))
        self.locals.clear()
        self.locals.update(before)
        return found
