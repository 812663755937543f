"""The situations that rules speak about: "whenever people are observed, ..." is about people.

``G(p -> X a)`` and ``G(p -> X b)`` are satisfied together by a world in which ``p`` never happens,
so satisfiability alone says little. A *trigger* is a situation, as a formula, in which a rule asks
for something; a feasible contract can be kept when it arises.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from vaso.ltl import (
    TRUE,
    Binary,
    Formula,
    Unary,
    conjunction,
    eventually,
    is_propositional,
    nnf,
    propositions,
    simplify,
    variables,
)

__all__ = ["Trigger", "triggers"]


@dataclass(frozen=True, slots=True)
class Trigger:
    """A situation in which a rule asks for something.

    Attributes:
        situation: The antecedent: ``people_observed``.
        occurs: That it arises where the rule looks for it: ``F people_observed`` under ``G``.
    """

    situation: Formula
    occurs: Formula


def triggers(rule: Formula, is_observation: Callable[[str], bool]) -> list[Trigger]:
    """List the triggers of a rule.

    They are the antecedents of the implications that the rule asserts: at the top, in a
    conjunction, under ``G`` or ``X``, or in the consequent of another implication. Where an
    antecedent is a disjunction, ``(p | q) -> r`` stands for ``p -> r`` and ``q -> r``, and every
    part that speaks only of observations is a trigger of its own: the world decides about it, not
    the robot.

    Args:
        rule: The rule.
        is_observation: Tells whether a proposition is decided by the world.
    """
    found = [
        Trigger(situation, simplify(occurs))
        for antecedent, context in _antecedents(rule)
        for situation, occurs in _split(antecedent, context, is_observation)
    ]
    unique = {t.occurs: t for t in reversed(found) if t.occurs != TRUE}
    return list(reversed(unique.values()))


_Context = Callable[[Formula], Formula]


def _antecedents(rule: Formula) -> Iterator[tuple[Formula, _Context]]:
    """Antecedents, each with a function from a situation to "it arises where the rule looks"."""
    match rule:
        case Binary("&", left, right):
            yield from _antecedents(left)
            yield from _antecedents(right)
        case Unary("G", body):
            yield from ((a, _after(eventually, c)) for a, c in _antecedents(body))
        case Unary("X", body):
            yield from ((a, _after(_next, c)) for a, c in _antecedents(body))
        case Binary("->", antecedent, consequent):
            yield antecedent, lambda situation: situation
            yield from ((a, _after(_with(antecedent), c)) for a, c in _antecedents(consequent))


def _after(outer: _Context, inner: _Context) -> _Context:
    return lambda situation: outer(inner(situation))


def _next(formula: Formula) -> Formula:
    return Unary("X", formula)


def _with(antecedent: Formula) -> _Context:
    return lambda situation: conjunction([antecedent, situation])


def _split(
    antecedent: Formula, occurs: _Context, is_observation: Callable[[str], bool]
) -> Iterator[tuple[Formula, Formula]]:
    parts = list(_disjuncts(nnf(antecedent))) if is_propositional(antecedent) else []
    sensed = [p for p in parts if not variables(p) and all(map(is_observation, propositions(p)))]
    if len(sensed) < len(parts) or len(parts) < 2:
        yield antecedent, occurs(antecedent)
    if len(parts) > 1:
        yield from ((part, occurs(part)) for part in sensed)


def _disjuncts(formula: Formula) -> Iterator[Formula]:
    match formula:
        case Binary("|", left, right):
            yield from _disjuncts(left)
            yield from _disjuncts(right)
        case _:
            yield formula
