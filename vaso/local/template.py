"""Read a plan template as far as a grammar can build on it: settings, functions, the rest.

A template begins with settings: assignments whose values have a certain kind. The grammar keeps
them, in their order, so that every variable that a plan uses has a value of that kind; literal
values may change, computed ones keep their formula. Functions keep their heads. What cannot be
understood is left out, and so is everything that depends on it.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from vaso.local.kinds import Kind, joined, kind_of, needs_int
from vaso.local.vocabulary import Vocabulary

MODULES = ("math", "time")
_CLOSED = (
    ast.Return, ast.Global, ast.Nonlocal, ast.Try, ast.With, ast.FunctionDef, ast.ClassDef,
    ast.Lambda, ast.Yield, ast.YieldFrom, ast.Import, ast.ImportFrom, ast.AsyncFunctionDef,
)  # fmt: skip


@dataclass(frozen=True)
class Setting:
    """One line that gives variables their first values.

    Attributes:
        node: The assignment.
        kinds: Kind by variable.
    """

    node: ast.Assign | ast.AnnAssign
    kinds: Mapping[str, Kind]


@dataclass(frozen=True)
class Function:
    """A function of the template.

    Attributes:
        name: Its name.
        parameters: Kind by parameter.
        settings: Its own first assignments.
        body: What comes after them.
    """

    name: str
    parameters: Mapping[str, Kind]
    settings: tuple[Setting, ...]
    body: tuple[ast.stmt, ...]


@dataclass(frozen=True)
class Template:
    """A plan template.

    Attributes:
        head: Imports (as text), settings and functions, in their order.
        main: The statements after them.
    """

    head: tuple[str | Setting | Function, ...] = ()
    main: tuple[ast.stmt, ...] = field(default=())

    @property
    def functions(self) -> list[Function]:
        """The functions."""
        return [item for item in self.head if isinstance(item, Function)]

    @property
    def variables(self) -> dict[str, Kind]:
        """Kinds of the variables of the head."""
        return {n: k for s in self.head if isinstance(s, Setting) for n, k in s.kinds.items()}


def read_template(source: str, words: Vocabulary) -> Template:
    """Read a template.

    Args:
        source: Its text; one that is not Python reads as an empty template.
        words: What it may call.
    """
    try:
        body = ast.parse(source).body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return Template()
    return _Reader(words, body).read()


class _Reader:
    def __init__(self, words: Vocabulary, body: Sequence[ast.stmt]) -> None:
        self._words = words
        self._body = body

    def read(self) -> Template:
        head: list[str | Setting | Function] = []
        known: dict[str, Kind] = {}
        rest = list(self._body)
        while rest:
            statement = rest[0]
            if isinstance(statement, ast.Import) and _is_plain_import(statement):
                head.append(ast.unparse(statement))
            elif isinstance(statement, ast.FunctionDef):
                pass
            elif isinstance(statement, (ast.Assign, ast.AnnAssign)):
                setting = self._setting(statement, known, self._body, self._words.settings)
                if setting is not None:
                    head.append(setting)
                    known.update(setting.kinds)
            elif not _is_docstring(statement):
                break
            rest.pop(0)
        return Template(tuple(self._with_functions(head, known)), tuple(rest))

    def _with_functions(
        self, head: list[str | Setting | Function], known: Mapping[str, Kind]
    ) -> Iterator[str | Setting | Function]:
        """The head with its functions in place; they may read every variable of the head."""
        todo = {id(s.node): s for s in head if isinstance(s, Setting)}
        yield from (line for line in head if isinstance(line, str))
        for statement in self._body:
            if id(statement) in todo:
                yield todo[id(statement)]
            elif function := self._function(statement, known):
                yield function

    def _setting(
        self,
        node: ast.Assign | ast.AnnAssign,
        known: Mapping[str, Kind],
        body: Sequence[ast.stmt],
        fixed: frozenset[str] = frozenset(),
    ) -> Setting | None:
        pairs = [] if node.value is None else list(_pairs(node))
        kinds = {name: kind_of(value, known, self._words.returns) for name, value in pairs}
        literal = node.value is not None and is_literal(node.value)
        if not kinds or None in kinds.values():
            return None
        if set(kinds) & fixed and (not literal or set(kinds) & fixed & set(known)):
            return None
        if any(n in known and joined((known[n], k)) != known[n] for n, k in kinds.items()):
            return None
        for name, kind in kinds.items():
            if kind == "int" and literal and not needs_int(name, body):
                kinds[name] = "float"
        return Setting(node, kinds)

    def _function(self, node: ast.stmt, known: Mapping[str, Kind]) -> Function | None:
        if not isinstance(node, ast.FunctionDef):
            return None
        arguments = node.args
        unusual = arguments.vararg or arguments.kwarg or arguments.kwonlyargs or arguments.defaults
        if unusual or node.decorator_list or node.name in {*self._words.names, *known}:
            return None
        body = [s for s in node.body if not _is_docstring(s)]
        if any(isinstance(inner, _CLOSED) for s in body for inner in ast.walk(s)):
            return None
        names = [a.arg for a in (*arguments.posonlyargs, *arguments.args)]
        parameters = {n: "int" if _is_count(n, body) else "float" for n in names}
        if not all(self._fits(node.name, parameters, call) for call in _calls(self._body)):
            return None
        local = {**known, **parameters}
        settings: list[Setting] = []
        while body and isinstance(body[0], (ast.Assign, ast.AnnAssign)):
            setting = self._setting(body[0], local, body)
            if setting is None or set(setting.kinds) & set(known):
                break
            settings.append(setting)
            local.update(setting.kinds)
            body.pop(0)
        return Function(node.name, parameters, tuple(settings), tuple(body)) if body else None

    def _fits(self, name: str, parameters: Mapping[str, Kind], call: ast.Call) -> bool:
        """True unless a call hands over something that is no number, as far as that is known."""
        if not isinstance(call.func, ast.Name) or call.func.id != name:
            return True
        literals = [a for a in call.args if is_literal(a)]
        numbers = all(kind_of(a, {}, {}) in ("int", "float") for a in literals)
        return len(call.args) == len(parameters) and not call.keywords and numbers


def is_literal(node: ast.expr) -> bool:
    """True for a value that is written out."""
    try:
        ast.literal_eval(node)
    except (ValueError, TypeError, SyntaxError, RecursionError):
        return False
    return True


def targets(node: ast.Assign | ast.AnnAssign) -> list[ast.expr]:
    """What an assignment assigns to."""
    return node.targets if isinstance(node, ast.Assign) else [node.target]


def _pairs(node: ast.Assign | ast.AnnAssign) -> Iterator[tuple[str, ast.expr]]:
    """Variables with their values; nothing at all if one of them is no plain name."""
    assert node.value is not None
    found: list[tuple[str, ast.expr]] = []
    for target in targets(node):
        names = target.elts if isinstance(target, ast.Tuple) else [target]
        values = node.value.elts if isinstance(node.value, ast.Tuple) else [node.value]
        if len(names) != len(values) or not all(isinstance(n, ast.Name) for n in names):
            return
        found += [(n.id, v) for n, v in zip(names, values, strict=True) if isinstance(n, ast.Name)]
    yield from found


def _is_count(name: str, body: Sequence[ast.stmt]) -> bool:
    """True for a parameter that says how often: ``range(n)``, or a list ``* n``."""
    for node in (inner for statement in body for inner in ast.walk(statement)):
        match node:
            case ast.Call(func=ast.Name(id="range"), args=arguments):
                if any(_is_name(a, name) for a in arguments):
                    return True
            case ast.BinOp(left=ast.List(), op=ast.Mult(), right=right):
                if _is_name(right, name):
                    return True
    return False


def _is_name(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Name) and node.id == name


def _calls(body: Sequence[ast.stmt]) -> Iterator[ast.Call]:
    for statement in body:
        yield from (n for n in ast.walk(statement) if isinstance(n, ast.Call))


def _is_plain_import(node: ast.Import) -> bool:
    return all(a.name in MODULES and a.asname is None for a in node.names)


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
