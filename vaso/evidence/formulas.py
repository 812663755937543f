"""Random rules over the propositions of a plan."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random

from vaso.ltl import Binary, Comparison, Constant, Formula, Number, Proposition, Unary, Variable
from vaso.ltl.syntax import BinaryOp, ComparisonOp, UnaryOp
from vaso.plan.transition_system import TransitionSystem

_UNARY: tuple[UnaryOp, ...] = ("!", "X", "F", "G", "X", "F", "G")
_PAST: tuple[UnaryOp, ...] = ("Y", "Z", "O", "H")
_BINARY: tuple[BinaryOp, ...] = ("&", "|", "xor", "->", "<->", "U", "V", "W")
_PAST_BINARY: tuple[BinaryOp, ...] = ("S", "T")
_RELATIONS: tuple[ComparisonOp, ...] = ("<", "<=", ">", ">=", "==", "!=")
_BOUNDS = (0.0, 0.2, 0.3, 0.5)
_PATTERNS = (
    "G({0} -> X {1})", "G({0} -> F {1})", "F {0} -> F {1}", "G !({0} & {1})", "{0} W {1}",
    "G F {0} -> G F {1}", "F G {0}", "G({0} -> X G {1})", "({0} & X {1}) | G {2}", "G {0} | F {1}",
    "!{0} U {1}",
)  # fmt: skip


def random_formulas(system: TransitionSystem, random: Random, count: int) -> list[Formula]:
    """Formulas over the propositions of a system: half of usual patterns, half of any shape.

    Args:
        system: The system; its first state has every proposition.
        random: Where they come from.
        count: How many.
    """
    first = system.states[0]
    booleans = {n for n, v in first.labels.items() if isinstance(v, bool)} | set(first.observed)
    numbers = {n for n in first.labels if n not in booleans}
    maker = _Maker(random, sorted(booleans), sorted(numbers))
    return [maker.pattern() if i % 2 else maker.formula(random.randint(1, 5)) for i in range(count)]


class _Maker:
    def __init__(self, random: Random, booleans: Sequence[str], numbers: Sequence[str]) -> None:
        self._random = random
        self._booleans = booleans
        self._numbers = numbers

    def pattern(self) -> Formula:
        from vaso.ltl import parse

        text = self._random.choice(_PATTERNS)
        return parse(text.format(*(f"({self._literal()})" for _ in range(3))))

    def formula(self, leaves: int) -> Formula:
        if leaves <= 1:
            return self._literal()
        kind = self._random.random()
        if kind < 0.5:
            operators = _UNARY if kind < 0.42 else _PAST
            return Unary(self._random.choice(operators), self.formula(leaves - 1))
        left = self._random.randint(1, leaves - 1)
        operator = self._random.choice(_BINARY if kind < 0.95 else _PAST_BINARY)
        return Binary(operator, self.formula(left), self.formula(leaves - left))

    def _literal(self) -> Formula:
        kind = self._random.random()
        if kind < 0.02:
            return Constant(self._random.random() < 0.5)
        if not self._booleans or (kind < 0.2 and self._numbers):
            sides = (
                Variable(self._random.choice(self._numbers)),
                Number(self._random.choice(_BOUNDS)),
            )
            return Comparison(sides[0], self._random.choice(_RELATIONS), sides[1])
        atom = Proposition(self._random.choice(self._booleans))
        return Unary("!", atom) if self._random.random() < 0.3 else atom
