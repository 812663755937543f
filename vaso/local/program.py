"""The grammar of plans that call commands: settings, functions, and lines at the top level."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence

from vaso.local import gbnf
from vaso.local.blocks import Blocks
from vaso.local.kinds import NUMBERS, Kind
from vaso.local.literals import head_line, settings_line
from vaso.local.scope import Scope
from vaso.local.template import Function, Template
from vaso.local.vocabulary import Vocabulary

LINES = (6, 4, 3, 2)
"""Lines of a block on each level, where the template has no longer ones."""
DEEPEST = 5
"""Levels of nesting that a template may ask for."""
CLOCKS = ("start", "start_time", "clock_start", "vaso_start")


def write_program(rules: gbnf.Rules, words: Vocabulary, template: Template) -> None:
    """Add the rules of plans that call commands; the root is ``root``.

    Args:
        rules: Where to add them.
        words: What plans may call.
        template: Its settings and functions are kept.
    """
    _Program(rules, words, template).write()


class _Program:
    def __init__(self, rules: gbnf.Rules, words: Vocabulary, template: Template) -> None:
        self._rules = rules
        self._template = template
        bodies = [template.main, *(f.body for f in template.functions)]
        depth = min(DEEPEST, max(len(LINES) - 1, *map(_nesting, bodies)))
        longest = max(map(_longest, bodies))
        self._sizes = tuple(max(n, longest) for n in LINES) + (longest,) * (depth + 1 - len(LINES))
        taken = set(template.variables) | {f.name for f in template.functions}
        taken |= {name for f in template.functions for name in _own(f)}
        taken |= {name for s in template.main if isinstance(s, ast.For) for name in _targets(s)}
        self._words = words.without(taken)
        taken |= words.names | words.constants
        self._clock = next(c for c in CLOCKS if c not in taken or c == CLOCKS[-1])

    def write(self) -> None:
        head: list[str] = []
        functions: dict[str, tuple[Kind, ...]] = {}
        for item in self._template.head:
            if isinstance(item, Function):
                head.append(self._function(item, functions))
                functions[item.name] = tuple(item.parameters.values())
            else:
                head.append(head_line(item))
        main = self._main(functions)
        entry = self._template.functions[-1:]
        optional = not self._template.main and any(not f.parameters for f in entry)
        self._rules.add("root", gbnf.seq(*head, gbnf.maybe(main) if optional else main))

    def _main(self, functions: Mapping[str, Sequence[Kind]]) -> str:
        kinds = self._template.variables
        assignable = frozenset(kinds) - self._words.constants
        scope = Scope("main", kinds, assignable, self._words, functions, self._template.main)
        self._blocks(scope, 0, first=tuple(self._loops(scope)))
        more = max(LINES[0], len(self._template.main)) - 1
        # An assignment alone would do nothing, and would make a function the plan's entry.
        line = gbnf.repeat("main-line0", 0, more)
        return self._rules.add("main", gbnf.seq("main-act0", line))

    def _function(self, function: Function, earlier: Mapping[str, Sequence[Kind]]) -> str:
        name = f"f{len(earlier) + 1}"
        kinds = {**self._template.variables, **_own(function)}
        own = frozenset(_own(function))
        self._blocks(Scope(name, kinds, own, self._words, dict(earlier), function.body), 1)
        head = gbnf.text(f"def {function.name}({', '.join(function.parameters)}):\n")
        settings = [settings_line(s, "    ") for s in function.settings]
        return self._rules.add(f"{name}-def", gbnf.seq(head, *settings, f"{name}-block1"))

    def _loops(self, main: Scope) -> Iterator[str]:
        """The template's loops over its lists, at the top level, with new bodies."""
        found = [n for n in main.body if isinstance(n, ast.For) and _elements(n, main.kinds)]
        heads = {gbnf.text(_head(n)): n for n in found}
        for number, (head, node) in enumerate(heads.items(), start=1):
            elements = _elements(node, main.kinds)
            kinds, assignable = {**main.kinds, **elements}, main.assignable - set(elements)
            name = f"each{number}"
            scope = Scope(name, kinds, assignable, self._words, main.functions, node.body)
            self._blocks(scope, 1)
            yield gbnf.seq(head, f"{name}-loop1")

    def _blocks(self, scope: Scope, depth: int, first: Sequence[str] = ()) -> None:
        scope.write(self._rules)
        Blocks(self._rules, scope, self._sizes, self._clock).write(depth, first)


def _own(function: Function) -> dict[str, Kind]:
    """A function's own variables."""
    return {**function.parameters, **{n: k for s in function.settings for n, k in s.kinds.items()}}


def _elements(node: ast.For, kinds: Mapping[str, Kind]) -> dict[str, Kind]:
    """The variables of a loop over a list of numbers or of tuples of numbers; empty for others."""
    kind = kinds.get(node.iter.id) if isinstance(node.iter, ast.Name) else None
    if not isinstance(kind, tuple) or kind[0] != "list" or kind[1] is None:
        return {}
    names, inner = _targets(node), kind[1]
    found = inner[1:] if isinstance(inner, tuple) and inner[0] == "tuple" else (inner,)
    if len(names) != len(found) or any(k not in NUMBERS for k in found):
        return {}
    variables = dict(zip(names, found, strict=True))
    return variables if all(kinds.get(n, k) == k for n, k in variables.items()) else {}


def _head(node: ast.For) -> str:
    return f"for {', '.join(_targets(node))} in {ast.unparse(node.iter)}:\n"


def _targets(node: ast.For) -> list[str]:
    """The variables of a loop, or nothing if they are nested."""
    parts = node.target.elts if isinstance(node.target, ast.Tuple) else [node.target]
    names = [p.id for p in parts if isinstance(p, ast.Name)]
    return names if len(names) == len(parts) else []


def _longest(body: Sequence[ast.stmt]) -> int:
    """Lines of the longest block inside of some statements."""
    return max((max(len(b), _longest(b)) for s in body for b in _bodies(s)), default=0)


def _nesting(body: Sequence[ast.stmt]) -> int:
    return max((1 + _nesting(b) for s in body for b in _bodies(s)), default=0)


def _bodies(statement: ast.stmt) -> Iterator[Sequence[ast.stmt]]:
    """The blocks of a statement; an ``elif`` counts as a block of the same ``if``."""
    body, other = getattr(statement, "body", []), getattr(statement, "orelse", [])
    yield body
    if len(other) == 1 and isinstance(other[0], ast.If) and isinstance(statement, ast.If):
        yield from _bodies(other[0])
    else:
        yield other
