"""What a plan may do with a robot and what sensors may say: the space that trials are drawn from.

Numbers are whole multiples of 1/1024. Sums of such numbers are exact in floating point, so that a
difference is one of meaning and not one of rounding; thresholds in the code and in the rules, and
their neighbours, are among them.
"""

from __future__ import annotations

import ast
import math
import random
from collections.abc import Iterable, Sequence
from typing import Any

from vaso.labels.functions import Parameter
from vaso.labels.sandbox import Sandbox
from vaso.labels.trial import Call, Hold, Operation, Send, Senses, Trial
from vaso.ltl import Formula
from vaso.ltl.numbers import DECIMALS
from vaso.ltl.syntax import Number
from vaso.ltl.traverse import comparisons, fold_term
from vaso.plan.transition_system import Scalar
from vaso.platforms import Command, Platform

__all__ = ["GRID", "Space"]

GRID = 1024
LONGEST = 6
"""Operations in a trial."""
LARGEST = 1_000_000.0
TEXTS = ("people", "obstacle", "")


class Space:
    """The space of trials.

    Args:
        sandbox: The labelling code.
        formulas: The rules; their numbers are worth trying.
    """

    def __init__(self, sandbox: Sandbox, formulas: Sequence[Formula] = ()) -> None:
        self.platform: Platform = sandbox.platform
        self.calls = _calls(sandbox)
        self.commands = self.platform.commands
        self.numbers = tuple(dict.fromkeys(_near([*_in_code(sandbox.tree), *_in_rules(formulas)])))
        self.keys = _sensor_keys(sandbox)
        track = self.platform.command(self.platform.trajectory or "")
        self.track = track if track and len(track.parameters) == 1 else None

    # -- drawing at random --------------------------------------------------------------------

    def draw(self, rng: random.Random) -> Trial:
        """A random trial. The distribution is described in docs/labels.md."""
        if self.track is not None and (not self.calls or rng.random() < 0.7):
            points = [self._send(self.track, rng, True) for _ in range(rng.randint(1, LONGEST))]
            operations: list[Operation] = list(points)
        else:
            operations = [self._operation(rng) for _ in range(rng.randint(1, LONGEST))]
        senses = tuple(self._senses(rng) for _ in range(len(operations) + 2))
        return Trial(tuple(operations), senses)

    def _operation(self, rng: random.Random) -> Operation:
        kind = rng.random()
        if kind < 0.7 and self.calls:
            name, parameters = rng.choice(self.calls)
            return Call(name, tuple(self._argument(p, rng) for p in parameters))
        if kind < 0.8 or not self.commands:
            return Hold(rng.randint(1, 3))
        return self._send(rng.choice(self.commands), rng, False)

    def _send(self, command: Command, rng: random.Random, track: bool) -> Send:
        values = [
            self._number(rng) if p.size is None else tuple(self._number(rng) for _ in range(p.size))
            for p in command.parameters
        ]
        return Send(command.issue(values, {}), track)

    def _senses(self, rng: random.Random) -> Senses:
        return {key: rng.choice(domain) for key, domain in self.keys.items()}

    def _argument(self, parameter: Parameter, rng: random.Random) -> Any:
        if parameter.kind == "bool":
            return rng.random() < 0.5
        if parameter.kind == "text":
            return rng.choice(TEXTS)
        if parameter.kind == "vector":
            return tuple(self._number(rng) for _ in range(self.width))
        return self._number(rng)

    def _number(self, rng: random.Random) -> float:
        kind = rng.random()
        if kind < 0.15:
            return 0.0
        if kind < 0.3 and self.numbers:
            return rng.choice(self.numbers)
        if kind < 0.6:
            return rng.randint(-16, 16) / 8
        if kind < 0.8:
            return rng.randint(-4 * GRID, 4 * GRID) / GRID
        return rng.randint(-80, 80) / 4

    @property
    def width(self) -> int:
        """How many numbers a vector has."""
        sizes = [p.size for c in self.commands for p in c.parameters if p.size]
        return sizes[0] if sizes else 3


def _calls(sandbox: Sandbox) -> list[tuple[str, tuple[Parameter, ...]]]:
    """Functions that do something when a plan calls them."""
    functions, tree = sandbox.functions, sandbox.tree
    words = {
        n.name: {getattr(m, "id", None) or getattr(m, "attr", None) for m in ast.walk(n)}
        for n in tree.body
        if isinstance(n, ast.FunctionDef)
    }
    doing = {n for n in functions.callable if n in sandbox.labelling.acting | sandbox.changing}
    doing |= {n for n in functions.callable if "sleep" in words.get(n, ())}
    fed = {name for name, kinds in functions.labels.items() if kinds}
    return [
        (name, given)
        for name, given in sorted(functions.variants(), key=_name)
        if name in doing - fed
    ]


def _name(call: tuple[str, tuple[Parameter, ...]]) -> str:
    return call[0]


def _sensor_keys(sandbox: Sandbox) -> dict[str, tuple[Scalar, ...]]:
    """Every raw sensor that the code reads or that decides an observation, with its domain."""
    calls = [Call(name) for name, parameters in _calls(sandbox) if not parameters]
    for trial in [Trial(()), *(Trial((call,)) for call in calls)]:
        list(sandbox.run([trial]))
    found = dict(sandbox.keys)
    for spec in sandbox.platform.propositions:
        sensor = sandbox.platform.sensor_of(spec.sensor or "")
        if spec.sensor and sensor:
            found[spec.sensor] = sensor.domain
    return dict(sorted(found.items()))


def _in_code(tree: ast.AST) -> Iterable[float]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            yield node.value  # type: ignore[misc]


def _in_rules(formulas: Sequence[Formula]) -> Iterable[float]:
    found: list[float] = []

    def note(term: Any, _: Any) -> None:
        if isinstance(term, Number):
            found.append(round(term.value, DECIMALS))

    for formula in formulas:
        for comparison in comparisons(formula):
            fold_term(comparison.left, note)
            fold_term(comparison.right, note)
    return sorted(found)


def _near(values: Iterable[float]) -> Iterable[float]:
    """The multiples of 1/1024 at and beside some numbers, of both signs."""
    for value in values:
        if abs(value) < LARGEST:
            for step in (math.floor(value * GRID), math.ceil(value * GRID)):
                for beside in (step, step + GRID // 8, step - GRID // 8):
                    yield beside / GRID
                    yield -beside / GRID
