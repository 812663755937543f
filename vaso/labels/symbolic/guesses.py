"""Guesses on what always holds between loop variables, the robot and the last set-point."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import TypeAlias

import z3

from vaso.labels.symbolic.mathematics import negative
from vaso.labels.symbolic.values import Value, compare, equal, is_term
from vaso.labels.symbolic.world import parts

__all__ = ["Guess", "Quantities", "all_guesses", "meaning", "of_point", "of_robot", "surely"]

Guess: TypeAlias = tuple[str, str, str]
"""(relation, one quantity, another): ``("==", "loop 5:4 z", "robot 0")``."""

Quantities: TypeAlias = dict[str, Value]


def of_robot(world: Value) -> Quantities:
    """The numbers in the robot's state."""
    return {f"robot {i}": part for i, part in enumerate(parts(world))}


def of_point(point: Value) -> Quantities:
    """The numbers in the last set-point."""
    return {f"last {i}": part for i, part in enumerate(point)}


def surely(fact: Value) -> bool:
    """True where a fact holds whatever is not known."""
    return fact is True or (is_term(fact) and z3.is_true(z3.simplify(fact)))


def all_guesses(base: Quantities) -> Iterator[Guess]:
    """What may always hold between the variables of loops, the robot and the last set-point."""
    numbers = [n for n, v in base.items() if not isinstance(v, bool)]
    for number, one in enumerate(numbers):
        if one.startswith("robot"):
            yield ("0 <=", one, one)
        for other in numbers[number + 1 :]:
            if one.startswith("loop") or other.startswith(("robot", "last")):
                yield ("==", one, other)
                yield ("== -", one, other)
            yield ("<=", one, other)
            yield ("<=", other, one)


def meaning(guess: Guess, known: Quantities) -> Value:
    """What a guess says of some quantities."""
    relation, one, other = guess[0], known[guess[1]], known[guess[2]]
    match relation:
        case "0 <=":
            return compare(ast.LtE(), 0, one)
        case "<=":
            return compare(ast.LtE(), one, other)
        case "== -":
            return equal(one, negative(other))
    return equal(one, other)
