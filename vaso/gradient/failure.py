"""Why a formula is false on a behaviour: one step and one literal, or something that never comes.

A counterexample shows a behaviour; what an author needs is the place in it. The search follows the
formula downwards and picks, at every operator, an operand that makes it false, so that what it ends
at is by itself enough for the violation.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from vaso.ltl import (
    Binary,
    Comparison,
    Constant,
    Formula,
    Proposition,
    Unary,
    evaluate,
    is_propositional,
    negate,
    nnf,
    past_depth,
    propositions,
    variables,
)
from vaso.verdict import Counterexample

__all__ = ["Behaviour", "Fact", "Failure", "find_failure"]


@dataclass(frozen=True, slots=True)
class Fact:
    """A formula that is true in a step."""

    formula: Formula
    step: int


@dataclass(frozen=True, slots=True)
class Failure:
    """What makes a formula false.

    Attributes:
        missing: The formula that should have been true: in ``step``, or once from ``step`` on.
        step: The step.
        never: True when it should have become true sooner or later and never does.
        because: What is true and makes the rule ask for it, in the order of the rule.
    """

    missing: Formula
    step: int
    never: bool = False
    because: tuple[Fact, ...] = ()


class Behaviour:
    """A counterexample as an infinite behaviour on which formulas are evaluated.

    Args:
        example: The counterexample.
        observed: The propositions that sensors decide.
        depth: How many turns of the loop to unroll, for formulas that look back.
    """

    def __init__(
        self, example: Counterexample, observed: frozenset[str] = frozenset(), depth: int = 0
    ) -> None:
        count, start = len(example.steps), example.loop_start
        self.example = example
        self.observed = observed
        self.order: list[int] = [*range(count), *list(range(start, count)) * depth]
        self.loop_start = start + (count - start) * depth
        self._truth: dict[Formula, tuple[bool, ...]] = {}

    @cached_property
    def labels(self) -> Sequence[dict[str, bool | float]]:
        """The propositions, step by step, unrolled."""
        return [dict(self.example.steps[i].labels) for i in self.order]

    def true(self, formula: Formula, position: int) -> bool:
        """Tell whether a formula is true at a position."""
        if formula not in self._truth:
            self._truth[formula] = evaluate(formula, self.labels, self.loop_start)
        return self._truth[formula][position]

    def after(self, position: int) -> int:
        """The next position."""
        return position + 1 if position + 1 < len(self.order) else self.loop_start

    def onwards(self, position: int) -> Iterator[int]:
        """Every position from one on, each once, in the order in which time meets it."""
        yield from range(position, len(self.order))
        yield from range(self.loop_start, position)

    def step(self, position: int) -> int:
        """The step of the counterexample at a position."""
        return self.order[position]

    def is_sensed(self, formula: Formula) -> bool:
        """Tell whether a formula speaks of what sensors decide, in one step."""
        names = propositions(formula)
        return (
            is_propositional(formula)
            and bool(names)
            and names <= self.observed
            and not variables(formula)
        )


def find_failure(
    formula: Formula, example: Counterexample, observed: frozenset[str] = frozenset()
) -> Failure | None:
    """Find what makes a formula false on a counterexample.

    Args:
        formula: The formula.
        example: A behaviour on which it is false.
        observed: The propositions that sensors decide.

    Returns:
        The failure, or None if the formula is true on the behaviour.

    Raises:
        FormulaError: The counterexample does not give a value to some proposition.
    """
    behaviour = Behaviour(example, observed, past_depth(formula))
    if behaviour.true(formula, 0):
        return None
    return _Search(behaviour).run(formula, 0, ())


class _Search:
    def __init__(self, behaviour: Behaviour) -> None:
        self.on = behaviour

    def run(self, formula: Formula, at: int, because: tuple[Fact, ...]) -> Failure:
        """The failure of a formula that is false at a position."""
        match formula:
            case Unary("!", operand):
                return self._negation(operand, at, because)
            case Unary("X", operand):
                return self.run(operand, self.on.after(at), because)
            case Unary("G", operand):
                where = self._first(at, operand, False)
                return self.run(operand, at if where is None else where, because)
            case Unary("F", operand):
                return Failure(operand, self.on.step(at), True, because)
            case Binary("&", left, right):
                return self.run(right if self.on.true(left, at) else left, at, because)
            case Binary("->", left, right):
                return self.run(right, at, because + support(left, at, self.on))
            case Binary("|", left, right):
                return self._disjunction(left, right, at, because)
            case Binary("U" | "W", left, right):
                return self._until(left, right, at, because)
            case Binary("V", _, right):
                where = self._first(at, right, False)
                return self.run(right, at if where is None else where, because)
        return Failure(formula, self.on.step(at), False, because)

    def _negation(self, operand: Formula, at: int, because: tuple[Fact, ...]) -> Failure:
        """Push the negation down by one operator and go on."""
        match operand:
            case Unary("!", inner):
                return self.run(inner, at, because)
            case Unary("X" | "F" | "G" as op, inner):
                dual = {"X": "X", "F": "G", "G": "F"}[op]
                return self.run(Unary(dual, negate(inner)), at, because)  # type: ignore[arg-type]
            case Binary("|", left, right):
                return self.run(Binary("&", negate(left), negate(right)), at, because)
            case Binary("->", left, right):
                return self.run(Binary("&", left, negate(right)), at, because)
            case Binary("&", left, right) if self.on.is_sensed(left) != self.on.is_sensed(right):
                given, other = (left, right) if self.on.is_sensed(left) else (right, left)
                return self.run(Binary("->", given, negate(other)), at, because)
            case Comparison() | Proposition() | Constant():
                return Failure(nnf(negate(operand)), self.on.step(at), False, because)
        return Failure(negate(operand), self.on.step(at), False, because)

    def _disjunction(
        self, left: Formula, right: Formula, at: int, because: tuple[Fact, ...]
    ) -> Failure:
        """``!p | q`` asks the same as ``p -> q``, whichever way round it is written."""
        if self.on.is_sensed(left) != self.on.is_sensed(right):
            given, other = (left, right) if self.on.is_sensed(left) else (right, left)
            return self.run(Binary("->", negate(given), other), at, because)
        return Failure(Binary("|", left, right), self.on.step(at), False, because)

    def _until(self, left: Formula, right: Formula, at: int, because: tuple[Fact, ...]) -> Failure:
        """``p U q`` fails where ``p`` ends too early, or because ``q`` never comes."""
        where = self._first(at, left, False)
        if where is not None:
            return self.run(left, where, because)
        return Failure(right, self.on.step(at), True, because)

    def _first(self, at: int, formula: Formula, value: bool) -> int | None:
        return next((i for i in self.on.onwards(at) if self.on.true(formula, i) is value), None)


def support(formula: Formula, at: int, on: Behaviour) -> tuple[Fact, ...]:
    """What makes a formula true at a position: literals where possible, each with its step."""
    whole = (Fact(formula, on.step(at)),)
    match formula:
        case Unary("!", Proposition() | Constant()):
            return whole
        case Unary("!", operand) if is_propositional(operand):
            return support(nnf(formula), at, on)
        case Unary("X", operand):
            return support(operand, on.after(at), on)
        case Unary("F", operand):
            return support(operand, _when(operand, at, on), on)
        case Binary("&", left, right):
            return support(left, at, on) + support(right, at, on)
        case Binary("|", left, right):
            return support(left if on.true(left, at) else right, at, on)
        case Binary("U", _, right):
            return support(right, _when(right, at, on), on)
    return whole


def _when(formula: Formula, at: int, on: Behaviour) -> int:
    return next(i for i in on.onwards(at) if on.true(formula, i))
