"""The grammar of plans that are lists of set-points: settings, then lines that add to the list."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping

from vaso.local import gbnf
from vaso.local.kinds import NUMBERS, Kind, joined, kind_of
from vaso.local.literals import head_line
from vaso.local.scope import BASICS
from vaso.local.template import Function, Setting, Template
from vaso.local.vocabulary import Vocabulary
from vaso.platforms import Platform

LINES = 8
SEGMENTS = 2
POINTS = 7
DEFAULT = "vel_traj"
SMALL = {
    "uint": '"0" | [1-9] [0-9]?',
    "count": "[1-9] [0-9]?",
    "number": '"-"? ("0" | "0.0" | "0." [1-9] [0-9]? | [1-9] [0-9]? ("." [0-9]{1,2})?)',
}
"""Quotients of these numbers are lengths of lists, so they are neither large nor tiny."""


def write_setpoints(
    rules: gbnf.Rules, words: Vocabulary, template: Template, robot: Platform
) -> bool:
    """Add the rules of plans that leave a list of set-points; the root is ``root``.

    Args:
        rules: Where to add them.
        words: What the template may call.
        template: Its settings are kept, and the list has the name that it has there.
        robot: The platform.

    Returns:
        False, with nothing added, if plans of this skill send commands instead.
    """
    command = robot.command(robot.trajectory or "")
    if command is None:
        return False
    size = next((p.size for p in command.parameters if p.size), 1)
    plan = _Setpoints(rules, words, template, size)
    name = plan.find_list()
    if name is None and (template.main or template.functions):
        return False
    plan.write(name or DEFAULT)
    return True


class _Setpoints:
    def __init__(self, rules: gbnf.Rules, words: Vocabulary, template: Template, size: int) -> None:
        self._rules = rules
        self._words = words
        self._template = template
        self._size = size

    def find_list(self) -> str | None:
        """The variable that the template leaves its set-points in: the last one of that kind."""
        known: dict[str, Kind] = dict(self._template.variables)
        found = [name for name, kind in known.items() if self._depth(kind) == 1]
        for node in self._template.main:
            match node:
                case ast.Assign(targets=[ast.Name(id=name)], value=value):
                    known[name] = self._kind(value, known)
                case ast.AugAssign(target=ast.Name(id=name), op=ast.Add(), value=value):
                    known[name] = joined((known.get(name), self._kind(value, known)))
                case ast.For(body=[ast.Assign() | ast.AugAssign() as inner]):
                    target = inner.targets[0] if isinstance(inner, ast.Assign) else inner.target
                    name = target.id if isinstance(target, ast.Name) else ""
                case _:
                    continue
            if self._depth(known.get(name)) == 1:
                found.append(name)
        return found[-1] if found else None

    def write(self, name: str) -> None:
        """Add the rules, for a list of this name."""
        for rule, expression in {**BASICS, **SMALL}.items():
            self._rules.add(rule, expression)
        head: list[str] = []
        known: dict[str, Kind] = {}
        begun = False
        for item in self._template.head:
            if isinstance(item, Setting) and set(item.kinds) == {name}:
                if not begun:
                    head.append(head_line(item) if _is_empty(item) else self._first(name, known))
                begun = True
            elif not isinstance(item, Function):
                head.append(head_line(item))
                known.update(item.kinds if isinstance(item, Setting) else {})
        if not begun:
            head.append(self._first(name, known))
        self._segment("segment", known)
        self._rules.add("line", gbnf.alt(self._lines(name, known)))
        self._rules.add("root", gbnf.seq(*head, gbnf.repeat("line", 1, LINES)))

    def _first(self, name: str, known: Mapping[str, Kind]) -> str:
        self._segment("begin", known)
        return gbnf.seq(gbnf.text(f"{name} = "), self._sum("begin"), gbnf.text("\n"))

    def _lines(self, name: str, known: Mapping[str, Kind]) -> Iterator[str]:
        sign = gbnf.texts([f"{name} += ", f"{name} = {name} + "])
        yield gbnf.seq(sign, self._sum("segment"), gbnf.text("\n"))
        lists = [n for n, kind in known.items() if self._depth(kind) == 2]
        for each in lists:
            part = self._loop_variable(each, {*known, name})
            segment = gbnf.alt([gbnf.text(part), "segment"])
            head = gbnf.text(f"for {part} in {each}:\n    ")
            yield gbnf.seq(head, sign, self._sum(segment), gbnf.text("\n"))

    def _loop_variable(self, each: str, taken: set[str]) -> str:
        """What the template calls the elements of a list."""
        for node in self._template.main:
            match node:
                case ast.For(target=ast.Name(id=name), iter=ast.Name(id=over)):
                    if over == each and name not in taken:
                        return name
        return f"one_of_{each}"

    def _sum(self, segment: str) -> str:
        return gbnf.seq(segment, gbnf.repeat(gbnf.seq(gbnf.text(" + "), segment), 0, SEGMENTS))

    def _segment(self, name: str, known: Mapping[str, Kind]) -> None:
        """Rules for a piece of the list: one of the variables, or set-points written out."""
        variables = [n for n, kind in known.items() if kind in NUMBERS]
        counts = ["count", *(gbnf.text(n) for n, kind in known.items() if kind == "int")]
        component = "number"
        if variables:
            rule = self._rules.add(f"{name}-var", gbnf.texts(variables))
            component = self._rules.add(f"{name}-value", f'"-"? {rule} | number')
            ratio = gbnf.seq(rule, gbnf.text(" / "), gbnf.alt([rule, "number"]))
            counts.append(gbnf.seq(gbnf.texts(["round(", "math.ceil("]), ratio, gbnf.text(")")))
        parts = gbnf.separated([component] * self._size)
        tail = gbnf.text(",)") if self._size == 1 else gbnf.text(")")
        point = self._rules.add(f"{name}-point", gbnf.seq(gbnf.text("("), *parts, tail))
        several = gbnf.repeat(gbnf.seq(gbnf.text(", "), point), 0, POINTS)
        repeated = gbnf.seq(gbnf.text("["), point, gbnf.text("] * "), gbnf.alt(counts))
        written = gbnf.seq(gbnf.text("["), point, several, gbnf.text("]"))
        lists = [gbnf.text(n) for n, kind in known.items() if self._depth(kind) == 1]
        self._rules.add(name, gbnf.alt([*lists, repeated, written]))

    def _kind(self, node: ast.expr, known: Mapping[str, Kind]) -> Kind | None:
        return kind_of(node, known, self._words.returns)

    def _depth(self, kind: Kind | None) -> int:
        """1 for a list of set-points, 2 for a list of such lists, 0 for anything else."""
        if not isinstance(kind, tuple) or kind[0] != "list":
            return 0
        inner = kind[1]
        if isinstance(inner, tuple) and inner[0] == "tuple":
            fits = len(inner) == 1 + self._size and all(k in NUMBERS for k in inner[1:])
            return 1 if fits else 0
        return 2 if self._depth(inner) == 1 else 0


def _is_empty(item: Setting) -> bool:
    return isinstance(item.node.value, ast.List) and not item.node.value.elts
