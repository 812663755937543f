"""Past operators as memory: one bit for each, updated as the steps go by.

``Y p`` remembers ``p``; ``O``, ``H``, ``S`` and ``T`` remember their own value (Havelund & Roşu,
Synthesizing Monitors for Safety Properties, 2002).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from vaso.ltl.syntax import Atom, Binary, Constant, Formula, Unary
from vaso.ltl.traverse import PAST_OPERATORS, fold, operands, subformulas

__all__ = ["PastMemory", "value_in"]

_AT_FIRST = {"Y": False, "Z": True, "O": False, "H": True, "S": False, "T": True}


class PastMemory:
    """The past operators of a formula.

    Args:
        formula: A formula whose past operators stand in front of formulas without future.
    """

    def __init__(self, formula: Formula) -> None:
        self._nodes = [f for f in subformulas(formula) if _is_past_operator(f)]
        self.initial = tuple(_AT_FIRST[_op(n)] for n in self._nodes)

    def read(
        self, memory: tuple[bool, ...], letter: Mapping[Atom, bool]
    ) -> tuple[dict[Formula, bool], tuple[bool, ...]]:
        """The value of every past operator in a step, and the memory for the next step.

        Args:
            memory: The memory before the step.
            letter: The value of every atom in the step.
        """
        values: dict[Formula, bool] = {}
        after = []
        for node, bit in zip(self._nodes, memory, strict=True):
            parts = tuple(value_in(p, letter, values) for p in operands(node))
            values[node], kept = _step(_op(node), bit, parts)
            after.append(kept)
        return values, tuple(after)


def value_in(formula: Formula, letter: Mapping[Atom, bool], past: Mapping[Formula, bool]) -> bool:
    """The value, in a step, of a formula that does not look ahead."""
    if formula in past:
        return past[formula]

    def combine(node: Formula, parts: tuple[bool, ...]) -> bool:
        if node in past:
            return past[node]
        match node:
            case Constant(value):
                return value
            case Unary("!", _):
                return not parts[0]
            case Binary(op, _, _):
                return _BOOLEAN[op](*parts)
        return letter[node]  # type: ignore[index]

    return fold(formula, combine)


_BOOLEAN: Mapping[str, Callable[[bool, bool], bool]] = {
    "&": lambda a, b: a and b,
    "|": lambda a, b: a or b,
    "->": lambda a, b: not a or b,
    "<->": lambda a, b: a == b,
    "xor": lambda a, b: a != b,
}


def _step(op: str, bit: bool, parts: tuple[bool, ...]) -> tuple[bool, bool]:
    """The value of an operator, and its new bit."""
    if op in "YZ":
        return bit, parts[0]
    match op:
        case "O":
            value = parts[0] or bit
        case "H":
            value = parts[0] and bit
        case "S":
            value = parts[1] or (parts[0] and bit)
        case _:
            value = parts[1] and (parts[0] or bit)
    return value, value


def _is_past_operator(node: Formula) -> bool:
    return isinstance(node, Unary | Binary) and node.op in PAST_OPERATORS


def _op(node: Formula) -> str:
    assert isinstance(node, Unary | Binary)
    return node.op
