"""What plans of a skill may call: sensors, gauges and commands, each as a piece of a grammar."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from vaso.local import gbnf
from vaso.local.kinds import Kind
from vaso.ltl import propositions
from vaso.plan.labelling import Labelling
from vaso.platforms import Command, Platform, get_platform
from vaso.skill import Skill

BOOLEANS = '("True" | "False")'
NOUN = r'"\"" [a-z] [a-z0-9 _-]{0,23} "\""'
"""A text such as ``"trash bin"``, for the name of an object."""
_ANNOTATIONS = ("int", "float", "bool", "str")


@dataclass(frozen=True)
class Call:
    """How a function is called.

    Attributes:
        name: The function.
        arguments: Its arguments: what stands before the value (``linear=``), and the value: a piece
            of a grammar, or one of ``int`` and ``float`` for any number of that kind.
        size: For a function that takes one vector: its number of components.
    """

    name: str
    arguments: tuple[tuple[str, str], ...] = ()
    size: int = 0

    @property
    def fixed(self) -> bool:
        """True if it is written in the same way everywhere: no argument is a number."""
        return not self.size and all(kind not in ("int", "float") for _, kind in self.arguments)

    def write(self, number: str = "number", whole: str = "uint") -> str:
        """The call as a piece of a grammar.

        Args:
            number: What a number may be.
            whole: What a whole number may be.
        """
        if self.size:
            return gbnf.call(self.name, [gbnf.call("", [number] * self.size)])
        values = {"float": number, "int": whole}
        pairs = [(gbnf.text(label) if label else "", v) for label, v in self.arguments]
        return gbnf.call(self.name, [gbnf.seq(label, values.get(v, v)) for label, v in pairs])


@dataclass(frozen=True)
class Vocabulary:
    """What a skill's plans may call.

    Attributes:
        sensors: Calls that are true or false, by function name.
        gauges: Calls that give a number.
        commands: Calls that act.
        constants: Names that the labelling code defines; plans set them at the start or not at all.
        settings: Those of them that its functions read.
    """

    sensors: dict[str, Call] = field(default_factory=dict)
    gauges: dict[str, Call] = field(default_factory=dict)
    commands: dict[str, Call] = field(default_factory=dict)
    constants: frozenset[str] = frozenset()
    settings: frozenset[str] = frozenset()

    @property
    def names(self) -> set[str]:
        """Everything that can be called."""
        return {*self.sensors, *self.gauges, *self.commands}

    def without(self, names: Iterable[str]) -> Vocabulary:
        """The same without what other things are named like."""
        taken = set(names)
        kept = [
            {n: call for n, call in calls.items() if n not in taken}
            for calls in (self.sensors, self.gauges, self.commands)
        ]
        return replace(self, sensors=kept[0], gauges=kept[1], commands=kept[2])

    @property
    def returns(self) -> dict[str, Kind]:
        """What the functions that can be called without arguments return."""
        return dict.fromkeys(self.sensors, "bool") | dict.fromkeys(self.gauges, "float")


def vocabulary(skill: Skill) -> Vocabulary:
    """Read a skill's vocabulary off its labelling code.

    The platform's own commands and sensors belong to it where the labelling code has none, and
    where the plan template calls them.

    Args:
        skill: The skill.

    Raises:
        LabellingError: The labelling code is not Python.
        PlatformError: There is no such platform.
    """
    robot = get_platform(skill.platform)
    labelling = Labelling(skill.labelling_code, robot)
    tree = ast.parse(skill.labelling_code)
    used = _called(skill.plan_template)
    nouns = _nouns(robot, [tree, _parsed(skill.plan_template)])
    functions = [n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name[0] != "_"]
    sensing = _reaching({s.name for s in robot.sensors}, functions)
    helpers = _helpers(functions, labelling.acting) - used - _propositions(skill)
    commands: dict[str, Call] = {}
    sensors: dict[str, Call] = {}
    gauges: dict[str, Call] = {}
    for node in functions:
        call = _call(node, nouns)
        kind = _returned(node, robot, sensors)
        if call is None or node.name in helpers:
            continue
        if node.name in labelling.acting:
            commands[node.name] = call
        elif kind == "bool":
            sensors[node.name] = call
        elif kind in ("int", "float") and node.name in sensing | used:
            gauges[node.name] = call
    low = {c.name for c in robot.commands} if not commands else used
    commands |= {c.name: _command(c) for c in robot.commands if c.name in low}
    low = {s.name for s in robot.sensors} if not (sensors or gauges) else used
    for sensor in robot.sensors:
        if sensor.name in low and set(sensor.domain) == {False, True}:
            sensors[sensor.name] = Call(sensor.name, (("", nouns),) * len(sensor.parameters))
    return Vocabulary(
        sensors,
        gauges,
        commands,
        constants=frozenset(labelling.constants),
        settings=frozenset(labelling.settings),
    )


def _helpers(functions: Sequence[ast.FunctionDef], acting: Iterable[str]) -> set[str]:
    """Functions that other functions use to act, such as ``set_velocity`` behind ``forward``."""
    bodies = {f.name: {_name(c) for c in _calls(f)} for f in functions if f.name in acting}
    return {name for name in bodies if any(name in b for f, b in bodies.items() if f != name)}


def _reaching(names: set[str], functions: Sequence[ast.FunctionDef]) -> set[str]:
    """Functions that call one of these, or a function that does."""
    bodies = {f.name: {_name(c) for c in _calls(f)} for f in functions}
    found = set(names)
    while more := {f for f, called in bodies.items() if called & found} - found:
        found |= more
    return found


def _propositions(skill: Skill) -> set[str]:
    platform = {p.name for p in get_platform(skill.platform).propositions}
    return platform.union(*(propositions(r.formula) for r in skill.rules))


def _calls(tree: ast.AST) -> Iterator[ast.Call]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            yield node


def _name(call: ast.Call) -> str:
    return call.func.id if isinstance(call.func, ast.Name) else ""


def _called(source: str) -> set[str]:
    return {_name(call) for call in _calls(_parsed(source))}


def _parsed(source: str) -> ast.AST:
    try:
        return ast.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ast.Module([], [])


def _nouns(robot: Platform, trees: Sequence[ast.AST]) -> str:
    """The texts that sensors are asked with, or any noun where none is known."""
    known = [ast.parse(p.sensor) for p in robot.propositions if p.sensor]
    given = [a for t in (*trees, *known) for call in _calls(t) for a in call.args]
    found = {a.value for a in given if isinstance(a, ast.Constant) and isinstance(a.value, str)}
    plain = sorted(t for t in found if t.isprintable() and not set(t) & set("\"\\'"))
    return gbnf.texts(f'"{t}"' for t in plain) if plain else NOUN


def _call(node: ast.FunctionDef, nouns: str) -> Call | None:
    """How to call a function; None if it needs something that cannot be written down here."""
    required = [*node.args.posonlyargs, *node.args.args]
    required = required[: len(required) - len(node.args.defaults)]
    if any(default is None for default in node.args.kw_defaults):
        return None
    kinds = [_annotation(a.annotation) for a in required]
    values = {"int": "int", "float": "float", "bool": BOOLEANS, "str": nouns}
    by_name = len(required) > 1 and not node.args.posonlyargs
    labels = [f"{a.arg}=" if by_name else "" for a in required]
    if None in kinds:
        return None
    return Call(node.name, tuple((n, values[str(k)]) for n, k in zip(labels, kinds, strict=True)))


def _command(command: Command) -> Call:
    """How to call a low-level command; a parameter with a default may be left out, and is not."""
    sizes = [p.size for p in command.parameters]
    if len(sizes) == 1 and sizes[0]:
        return Call(command.name, size=sizes[0])
    labels = [f"{p.name}=" if len(sizes) > 1 else "" for p in command.parameters]
    vector = [gbnf.call("", ["number"] * size) if size else "float" for size in sizes]
    return Call(command.name, tuple(zip(labels, vector, strict=True)))


def _annotation(node: ast.expr | None) -> str | None:
    name = node.id if isinstance(node, ast.Name) else getattr(node, "value", None)
    return name if name in _ANNOTATIONS else None


def _returned(node: ast.FunctionDef, robot: Platform, sensors: Iterable[str]) -> str | None:
    """The kind of value that a function returns, by its annotation or else by its code."""
    if node.returns is not None:
        return _annotation(node.returns)
    yields = {s.name for s in robot.sensors if set(s.domain) == {False, True}} | set(sensors)
    returns = [n.value for n in ast.walk(node) if isinstance(n, ast.Return)]
    return "bool" if returns and all(_is_true_or_false(v, yields) for v in returns) else None


def _is_true_or_false(node: ast.expr | None, yields: set[str]) -> bool:
    if isinstance(node, ast.BoolOp):
        return all(_is_true_or_false(v, yields) for v in node.values)
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Name) and node.func.id in yields
    if isinstance(node, ast.Constant):
        return isinstance(node.value, bool)
    return isinstance(node, ast.Compare) or (
        isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
    )
