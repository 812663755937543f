"""What a plan may write in one place: numbers, conditions, assignments and calls as grammar rules.

A place is the top level, a function, or a loop over a list: it has variables of certain kinds.
Expressions are kept small; what the template itself writes in such a place may be repeated.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from vaso.local import gbnf
from vaso.local.kinds import NUMBERS, Kind, kind_of
from vaso.local.vocabulary import Call, Vocabulary

BASICS = {
    "uint": '"0" | [1-9] [0-9]{0,2}',
    "count": "[1-9] [0-9]{0,2}",
    "number": '"-"? ("0" | [1-9] [0-9]{0,2}) ("." [0-9]{1,3})?',
    "duration": '"0." [1-9] | [1-9] [0-9]? "." [0-9]',
    "relation": '" < " | " <= " | " > " | " >= " | " == " | " != "',
    "junction": '" and " | " or "',
}
"""Rules that do not depend on the place. Counts and numbers are bounded, so that loops end."""
MORE_TESTS = 2


@dataclass(frozen=True)
class Scope:
    """A place in a plan, and the names of its rules.

    Attributes:
        name: What its rules' names begin with.
        kinds: Kind by variable.
        assignable: The variables that may be assigned here.
        words: What may be called.
        functions: The plan's own functions that can be called, with the kinds of their arguments.
        body: The template's statements in this place.
    """

    name: str
    kinds: Mapping[str, Kind]
    assignable: frozenset[str]
    words: Vocabulary
    functions: Mapping[str, Sequence[Kind]]
    body: Sequence[ast.stmt]

    def write(self, rules: gbnf.Rules) -> None:
        """Add the rules of this place: ``X-do``, ``X-set``, ``X-if``, ``X-times`` and others.

        ``X-see`` is a condition that begins with a sensor, ``X-check`` one that begins with a
        variable, ``X-if`` any condition. A rule is left out where there is nothing for it.
        """
        for name, rule in BASICS.items():
            rules.add(name, rule)
        self._write_numbers(rules)
        if self.words.sensors:
            call = rules.add(self.call, gbnf.alt(self._written(self.words.sensors)))
            pair = gbnf.seq(gbnf.text("not ("), call, "junction", call, gbnf.text(")"))
            rules.add(self.sensor, f'"not "? {call} | {pair}')
        self._write_conditions(rules)
        sleep = gbnf.call("time.sleep", ["duration"])
        rules.add(self.send, gbnf.alt([*self._written(self.words.commands), sleep]))
        rules.add(self.rule("do"), gbnf.alt([self.send, *self._calls()]))
        if options := [*self._updates(), *map(gbnf.text, self._own_assignments())]:
            rules.add(self.rule("set"), gbnf.alt(options))

    def rule(self, part: str) -> str:
        """The name of one of the rules."""
        return f"{self.name}-{part}"

    def names(self, *kinds: str) -> list[str]:
        """The variables of some kinds."""
        return [name for name, kind in self.kinds.items() if kind in kinds]

    @property
    def send(self) -> str:
        """The rule of commands; the same everywhere unless they take numbers."""
        return self._shared("send", self.words.commands)

    @property
    def call(self) -> str:
        """The rule of calls of sensors."""
        return self._shared("call", self.words.sensors)

    @property
    def sensor(self) -> str:
        """The rule of conditions on sensors alone."""
        return self._shared("sensor", self.words.sensors)

    def _shared(self, part: str, calls: Mapping[str, Call]) -> str:
        return part if all(c.fixed for c in calls.values()) else self.rule(part)

    def _written(self, calls: Mapping[str, Call]) -> list[str]:
        return [call.write(self._number(), self._whole()) for call in calls.values()]

    def _number(self) -> str:
        return self.rule("value") if self.names(*NUMBERS) else "number"

    def _calls(self) -> Iterator[str]:
        """Calls of the plan's own functions."""
        for name, kinds in self.functions.items():
            call = Call(name, tuple(("", kind) for kind in kinds))
            yield call.write(self._number(), self._whole())

    def _write_numbers(self, rules: gbnf.Rules) -> None:
        counts = ["count", *map(gbnf.text, self.names("int"))]
        if numbers := self.names(*NUMBERS):
            rules.add(self.rule("var"), gbnf.texts(numbers))
            rules.add(self.rule("value"), f"{self.rule('var')} | number")
            ratio = gbnf.seq(self.rule("var"), gbnf.text(" / "), self.rule("value"))
            counts.append(gbnf.seq(gbnf.texts(["round(", "math.ceil("]), ratio, gbnf.text(")")))
        counts += map(gbnf.text, self._own_counts())
        rules.add(self.rule("times"), gbnf.alt(counts))

    def _write_conditions(self, rules: gbnf.Rules) -> None:
        gauges = self._written(self.words.gauges)
        checks = [gbnf.seq(call, "relation", "number") for call in gauges]
        if self.names(*NUMBERS):
            checks.append(gbnf.seq(self.rule("var"), "relation", self.rule("value")))
        if flags := self.names("bool"):
            checks.append(gbnf.seq(gbnf.maybe(gbnf.text("not ")), gbnf.texts(flags)))
        checks += map(gbnf.text, self._own_tests())
        sensors = [self.sensor] if self.words.sensors else []
        if not checks and not sensors:
            return
        rules.add(self.rule("test"), gbnf.alt([*sensors, *checks]))
        more = gbnf.repeat(gbnf.seq("junction", self.rule("test")), 0, MORE_TESTS)
        rules.add(self.rule("if"), gbnf.seq(self.rule("test"), more))
        if sensors:
            rules.add(self.rule("see"), gbnf.seq(self.sensor, more))
        if checks:
            rules.add(self.rule("check"), gbnf.seq(gbnf.alt(checks), more))

    def _updates(self) -> Iterator[str]:
        """Assignments in which a variable keeps its kind, and grows by the same amount at most."""
        for name in sorted(self.assignable):
            kind = self.kinds[name]
            if kind == "bool":
                yield gbnf.seq(gbnf.text(f"{name} = "), gbnf.texts(["True", "False"]))
            elif kind in NUMBERS:
                value, step = self._whole(), "uint"
                if kind == "float":
                    value, step = self.rule("value"), "number"
                new = gbnf.seq(gbnf.text(" = "), value)
                signs = [f" = {name} + ", f" = {name} - ", " += ", " -= "]
                changed = gbnf.seq(gbnf.texts(signs), step)
                yield gbnf.seq(gbnf.text(name), gbnf.alt([new, changed]))

    def _whole(self) -> str:
        return gbnf.alt(["uint", *map(gbnf.text, self.names("int"))])

    # -- what the template writes here itself ---------------------------------------------------

    def _kind(self, node: ast.expr) -> Kind | None:
        return kind_of(node, self.kinds, self.words.returns)

    def _nodes(self) -> Iterator[ast.AST]:
        for statement in self.body:
            yield from ast.walk(statement)

    def _own_counts(self) -> Iterable[str]:
        for node in self._nodes():
            match node:
                case ast.Call(func=ast.Name(id="range"), args=[count]):
                    simple = isinstance(count, (ast.Name, ast.Constant))
                    if not simple and self._kind(count) == "int":
                        yield ast.unparse(count)

    def _own_tests(self) -> Iterable[str]:
        for node in self._nodes():
            if isinstance(node, ast.Compare) and self._kind(node) == "bool":
                sides = (node.left, *node.comparators)
                if not all(isinstance(s, (ast.Name, ast.Constant)) for s in sides):
                    yield ast.unparse(node)

    def _own_assignments(self) -> Iterable[str]:
        for node in self._nodes():
            match node:
                case ast.Assign(targets=[ast.Name(id=name)], value=value):
                    kind = self.kinds[name] if name in self.assignable else None
                    fits = kind in NUMBERS and self._kind(value) in (kind, "int")
                    if fits and not _is_update(name, value):
                        yield ast.unparse(node)


def _is_update(name: str, value: ast.expr) -> bool:
    """True for what :meth:`Scope._updates` writes anyway."""
    match value:
        case ast.Constant() | ast.Name():
            return True
        case ast.BinOp(left=ast.Name(id=left), op=ast.Add() | ast.Sub(), right=right):
            return left == name and isinstance(right, ast.Constant)
    return False
