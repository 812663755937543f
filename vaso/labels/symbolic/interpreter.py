"""Run a small part of Python on values that may not be known.

What is not understood raises :class:`NotUnderstoodError`: the interpreter never guesses.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from vaso.labels.symbolic.classes import class_of
from vaso.labels.symbolic.expressions import Expressions, Module
from vaso.labels.symbolic.history import History, Tail
from vaso.labels.symbolic.mathematics import MATH, binary
from vaso.labels.symbolic.paths import Path
from vaso.labels.symbolic.values import (
    Function,
    NotUnderstoodError,
    Poison,
    PythonError,
    Record,
    Value,
    is_symbolic,
)

__all__ = ["Interpreter", "LoopHook"]

MAX_TURNS = 200
MAX_DEPTH = 40

LoopHook = Callable[["Interpreter", ast.For, History, dict[str, Value]], None]
"""Runs a loop over set-points of which not all are known."""


class _Return(Exception):
    def __init__(self, value: Value) -> None:
        self.value = value


class _Break(Exception):
    pass


class _Continue(Exception):
    pass


@dataclass
class Interpreter(Expressions):
    """Runs functions on one path.

    Attributes:
        path: Decides what is not known.
        loop: Runs loops over set-points.
        depth: Calls within calls.
    """

    path: Path
    loop: LoopHook | None = None
    depth: int = 0
    _locals: list[dict[str, Value]] = field(default_factory=list)
    _globals: list[Any] = field(default_factory=list)
    _declared: list[set[str]] = field(default_factory=list)

    def call(self, function: Function, args: list[Value], kwargs: dict[str, Value]) -> Value:
        """Call a function."""
        if self.depth > MAX_DEPTH:
            raise NotUnderstoodError("calls nested too deeply")
        given = self._bind(function, args, kwargs)
        self.depth += 1
        self._locals.append({**function.outer, **given})
        self._globals.append(function.names)
        self._declared.append(set())
        try:
            if isinstance(function.node, ast.Lambda):
                return self.value(function.node.body)
            self.block(function.node.body)
        except _Return as end:
            return end.value
        finally:
            self.depth -= 1
            self._locals.pop()
            self._globals.pop()
            self._declared.pop()
        return None

    def run_module(self, body: list[ast.stmt], names: Any) -> None:
        """Run the statements of a module, which bind global names."""
        self._locals.append(names.found)
        self._globals.append(names)
        self._declared.append(set())
        self.block(body)
        self._locals.pop()
        self._globals.pop()
        self._declared.pop()

    def run_turn(self, node: ast.For, item: Value, known: dict[str, Value], names: Any) -> None:
        """Run the body of a loop once, on its own."""
        self._locals.append(known)
        self._globals.append(names)
        self._declared.append(set())
        self.turns(node, [item])
        self._locals.pop()
        self._globals.pop()
        self._declared.pop()

    def _bind(
        self, function: Function, args: list[Value], kwargs: dict[str, Value]
    ) -> dict[str, Value]:
        given = function.node.args
        names = [a.arg for a in (*given.posonlyargs, *given.args)]
        if given.vararg or given.kwarg or given.kwonlyargs:
            raise NotUnderstoodError("parameters other than plain ones")
        if len(args) > len(names) or not kwargs.keys() <= set(names):
            raise PythonError("TypeError: wrong arguments")
        found = dict(zip(names, args, strict=False)) | kwargs
        defaults = function.defaults
        if defaults is None:
            defaults = tuple(map(_constant, given.defaults))
        for name, default in zip(names[::-1], defaults[::-1], strict=False):
            found.setdefault(name, default)
        if len(found) != len(names):
            raise PythonError("TypeError: missing arguments")
        return found

    # -- names -------------------------------------------------------------------------------------

    @property
    def locals(self) -> dict[str, Value]:
        """The variables of the function that runs."""
        return self._locals[-1]

    def read(self, name: str) -> Value:
        """The value of a name."""
        if name in self.locals and name not in self._declared[-1]:
            value = self.locals[name]
        else:
            value = self._globals[-1].read(name)
        if isinstance(value, Poison):
            raise NotUnderstoodError(value.why)
        return value

    def write(self, name: str, value: Value) -> None:
        """Bind a name."""
        if name in self._declared[-1]:
            self._globals[-1].write(name, value)
        else:
            self.locals[name] = value

    @property
    def outer(self) -> dict[str, Value]:
        """The variables that a function defined here sees."""
        return {} if self.locals is getattr(self.names, "found", None) else self.locals

    @property
    def names(self) -> Any:
        """Finds global names for functions that are defined here."""
        return self._globals[-1]

    # -- statements --------------------------------------------------------------------------------

    def block(self, body: list[ast.stmt]) -> None:
        """Run statements."""
        for node in body:
            run = getattr(self, f"_run_{type(node).__name__}", None)
            if run is None:
                raise NotUnderstoodError(f"the statement {type(node).__name__}")
            run(node)

    def _run_Pass(self, node: ast.Pass) -> None:
        pass

    def _run_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):
            self.value(node.value)

    def _run_Global(self, node: ast.Global) -> None:
        self._declared[-1].update(node.names)

    def _run_Return(self, node: ast.Return) -> None:
        raise _Return(self.value(node.value) if node.value else None)

    def _run_Break(self, node: ast.Break) -> None:
        raise _Break

    def _run_Continue(self, node: ast.Continue) -> None:
        raise _Continue

    def _run_Raise(self, node: ast.Raise) -> None:
        raise PythonError("an exception")

    def _run_Assert(self, node: ast.Assert) -> None:
        if not self.path.decide(self.truth(self.value(node.test))):
            raise PythonError("AssertionError")

    def _run_If(self, node: ast.If) -> None:
        taken = self.path.decide(self.truth(self.value(node.test)))
        self.block(node.body if taken else node.orelse)

    def _run_FunctionDef(self, node: ast.FunctionDef) -> None:
        if node.decorator_list:
            raise NotUnderstoodError("a decorator")
        defaults = tuple(map(self.value, node.args.defaults))
        if any(isinstance(d, list | dict | Record) for d in defaults):
            raise NotUnderstoodError("a default that calls may change")
        self.write(node.name, Function(node, self.outer, self.names, defaults))

    def _run_ClassDef(self, node: ast.ClassDef) -> None:
        self.write(node.name, class_of(node, self.names))

    def _run_Import(self, node: ast.Import) -> None:
        for alias in node.names:
            module = Module() if alias.name == "math" else Poison(f"the module {alias.name}")
            self.write(alias.asname or alias.name, module)

    def _run_ImportFrom(self, node: ast.ImportFrom) -> None:
        for alias in node.names:
            known = node.module == "math" and alias.name in MATH
            value: Value = Poison(f"{node.module}.{alias.name}")
            self.write(
                alias.asname or alias.name, self.function_of_math(alias.name) if known else value
            )

    def _run_Assign(self, node: ast.Assign) -> None:
        value = self.value(node.value)
        for target in node.targets:
            self.assign(target, value)

    def _run_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.assign(node.target, self.value(node.value))

    def _run_AugAssign(self, node: ast.AugAssign) -> None:
        if not isinstance(node.target, ast.Name | ast.Attribute):
            raise NotUnderstoodError("an assignment to an element")
        before = self.value(
            ast.Name(node.target.id, ast.Load())
            if isinstance(node.target, ast.Name)
            else ast.Attribute(node.target.value, node.target.attr, ast.Load())
        )
        if isinstance(before, list | Tail):
            raise NotUnderstoodError("a list that is changed in place")
        self.assign(node.target, binary(node.op, before, self.value(node.value), self.path))

    def assign(self, target: ast.expr, value: Value) -> None:
        """Bind a target."""
        if isinstance(target, ast.Name):
            self.write(target.id, value)
        elif isinstance(target, ast.Tuple | ast.List):
            if not isinstance(value, list | tuple):
                raise NotUnderstoodError("the parts of something that is no vector")
            if len(value) != len(target.elts):
                raise PythonError("ValueError: wrong number of values")
            for part, one in zip(target.elts, value, strict=True):
                self.assign(part, one)
        elif isinstance(target, ast.Attribute):
            owner = self.value(target.value)
            if not isinstance(owner, Record):
                raise NotUnderstoodError("an attribute of something else than a simple object")
            self.change(owner)
            owner.fields[target.attr] = value
        else:
            raise NotUnderstoodError("an assignment to an element")

    def change(self, owner: Value) -> None:
        """Note that an object is changed; objects that outlive a call must not be."""
        if any(owner is one for one in self.names.shared()):
            raise NotUnderstoodError("an object of the module that is changed")

    # -- loops -------------------------------------------------------------------------------------

    def _run_For(self, node: ast.For) -> None:
        items = self.value(node.iter)
        if isinstance(items, History):
            if self.loop is None or node.orelse:
                raise NotUnderstoodError("a loop over set-points")
            self.loop(self, node, items, self.locals)
        elif self.turns(node, self.items(items)):
            self.block(node.orelse)

    def turns(self, node: ast.For, items: list[Value]) -> bool:
        """Run a loop over known items; True if it was not broken off."""
        if len(items) > MAX_TURNS:
            raise NotUnderstoodError("a long loop")
        for item in items:
            self.assign(node.target, item)
            try:
                self.block(node.body)
            except _Break:
                return False
            except _Continue:
                continue
        return True

    def _run_While(self, node: ast.While) -> None:
        for _ in range(MAX_TURNS):
            if not self.path.decide(self.truth(self.value(node.test))):
                self.block(node.orelse)
                return
            try:
                self.block(node.body)
            except _Break:
                return
            except _Continue:
                continue
        raise NotUnderstoodError("a long loop")

    def items(self, value: Value) -> list[Value]:
        """The items of something that can be gone through."""
        if isinstance(value, list | tuple | range | str):
            return list(value)
        if isinstance(value, dict) and not is_symbolic(list(value)):
            return list(value)
        raise NotUnderstoodError("a loop over something that is not known")


def _constant(node: ast.expr) -> Value:
    try:
        return ast.literal_eval(node)
    except ValueError as error:
        raise NotUnderstoodError("a default that is no constant") from error


def assigned(body: list[ast.stmt]) -> Iterator[str]:
    """Names that statements bind."""
    for statement in body:
        for node in ast.walk(statement):
            if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load):
                yield node.id
