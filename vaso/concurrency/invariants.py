"""Rules of the form ``G p``: searching the product place by place, without building it.

Most joint rules say that something never happens. They need no model checker: a breadth-first
search finds the shortest way to a place where ``p`` is false, or has seen every place.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field

from vaso.concurrency.building import cut_of
from vaso.concurrency.product import Place, Product, clock_of
from vaso.errors import FormulaError
from vaso.ltl import (
    FALSE,
    TRUE,
    Atom,
    Formula,
    Unary,
    evaluate,
    is_propositional,
    simplify,
    substitute,
)
from vaso.plan.atoms import atoms_of, names_of
from vaso.plan.explore import Budget
from vaso.plan.transition_system import Case, Cut, Guard, Scalar
from vaso.verdict import Verdict
from vaso.verification.cuts import explain
from vaso.verifiers.base import Answer, Lasso

__all__ = ["ENGINE", "Searched", "invariant_of", "search_invariant"]

ENGINE = "joint search"
MOST_VALUATIONS = 4_096
"""Sensor valuations that one place may tell apart."""


@dataclass(frozen=True, slots=True)
class Searched:
    """The answer to an invariant.

    Attributes:
        answer: The answer.
        vacuous: Why a PASS says nothing about the plans, or None.
        states: Places that were reached.
        transitions: Steps between them.
        cut: Why the search is not complete.
    """

    answer: Answer
    vacuous: str | None = None
    states: int = 0
    transitions: int = 0
    cut: Cut | None = None


def invariant_of(formula: Formula) -> Formula | None:
    """What an invariant says about each step; None for other formulas."""
    match formula:
        case Unary("G", operand) if is_propositional(operand):
            return operand
    return None


def search_invariant(
    product: Product, invariant: Formula, budget: Budget, deadline: float
) -> Searched:
    """Search the product for a place where the formula is false.

    Args:
        product: The product, best of reduced members.
        invariant: A formula about one step, over ``member.proposition``.
        budget: Bounds of the search.
        deadline: When to stop, on the monotonic clock.
    """
    started = time.perf_counter()
    search = _Search(product, invariant, budget, deadline)
    try:
        answer = search.run()
    except FormulaError as error:
        answer = Answer(Verdict.UNSUPPORTED, ENGINE, reason=str(error))
    seconds = time.perf_counter() - started
    answer = Answer(answer.verdict, ENGINE, seconds, answer.lasso, answer.reason)
    vacuous = search.truths.vacuous() if answer.verdict is Verdict.PASS else None
    return Searched(answer, vacuous, len(search.found_by), search.transitions, search.cut)


class _Search:
    """Breadth-first search over places, level by level."""

    def __init__(
        self, product: Product, invariant: Formula, budget: Budget, deadline: float
    ) -> None:
        self.product = product
        self.truths = _Truths(product, invariant)
        self.budget = budget
        self.deadline = min(deadline, time.monotonic() + budget.seconds)
        self.found_by: dict[Place, tuple[Place, Guard] | None] = {product.start: None}
        self.transitions = 0
        self.bound = ""
        self.cut: Cut | None = None

    def run(self) -> Answer:
        level, depth = [self.product.start], 0
        cut: list[tuple[Place, int]] = []
        while level:
            after: list[Place] = []
            for place in level:
                if self.product.is_cut(place) or self._spent():
                    cut.append((place, depth))
                    continue
                breach = self.truths.breach(place)
                if breach is not None:
                    return Answer(Verdict.FAIL, ENGINE, lasso=self._lasso(place, breach))
                after += self._expand(place)
            level, depth = after, depth + 1
        self.cut = cut_of(self.product, cut, self.bound)
        if self.cut is None:
            return Answer(Verdict.PASS, ENGINE)
        verdict = Verdict.UNKNOWN if self.cut.supported else Verdict.UNSUPPORTED
        return Answer(verdict, ENGINE, reason=explain(self.cut))

    def _expand(self, place: Place) -> list[Place]:
        new = []
        for move in self.product.moves(place):
            self.transitions += 1
            if move.target not in self.found_by:
                self.found_by[move.target] = (place, move.guard)
                new.append(move.target)
        return new

    def _spent(self) -> bool:
        if self.bound:
            return True
        if len(self.found_by) > self.budget.states:
            self.bound = f"the bound of {self.budget.states} joint states was reached"
        elif time.monotonic() > self.deadline:
            self.bound = "the time for the joint search was over"
        return bool(self.bound)

    def _lasso(self, place: Place, breach: Guard) -> Lasso:
        """The way to a breach, and on from there with everyone moving in turn."""
        values: list[Guard] = [breach]
        here = place
        while (before := self.found_by[here]) is not None:
            here, guard = before
            values.append(guard)
        turn = self.product.schedule.turn
        rest: list[Guard] = [{turn.name: v} for v in turn.domain] if turn else [{}]
        run = [*reversed(values), *rest]
        return Lasso(tuple((0, value) for value in run), len(values))


@dataclass
class _Truths:
    """The truth of a formula in places; places that look alike to it are evaluated once."""

    product: Product
    formula: Formula
    _known: dict[Hashable, Guard | None] = field(default_factory=dict)
    _seen: dict[Atom, set[bool]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.names = names_of(self.formula)
        self.atoms = atoms_of([self.formula])
        product = self.product
        self._own = [
            [n.removeprefix(f"{owner}.") for n in self.names if n.startswith(f"{owner}.")]
            for owner in product.names
        ]
        self._timed = any(clock_of(owner).name in self.names for owner in product.names)
        self._linked = any(product.wiring.links)
        self._looks: dict[tuple[int, int], Hashable] = {}

    def breach(self, place: Place) -> Guard | None:
        """Sensor values under which the formula is false in a place; None if there are none."""
        key = place if self._linked else self._look(place)
        if key not in self._known:
            self._known[key] = self._evaluate(place)
        return self._known[key]

    def vacuous(self) -> str | None:
        """Why the rule asks nothing: something that it needs to be broken never happens."""
        if len(self.atoms) < 2:
            return None
        never = [a for a in self.atoms if self._seen.get(a) == {False}]
        alone = [a for a in never if simplify(substitute(self.formula, {a: FALSE})) == TRUE]
        return f"it never happens that {alone[0]}" if alone else None

    def _look(self, place: Place) -> Hashable:
        looks = [self._look_of(i, n) for i, n in enumerate(place.states)]
        return (*looks, place.phase if self._timed else 0)

    def _look_of(self, member: int, number: int) -> Hashable:
        if (member, number) not in self._looks:
            state = self.product.systems[member].states[number]
            parts = [(n, repr(state.labels.get(n)), _frozen(state.observed.get(n, ())))
                     for n in self._own[member]]  # fmt: skip
            self._looks[member, number] = tuple(parts)
        return self._looks[member, number]

    def _evaluate(self, place: Place) -> Guard | None:
        state = self.product.state(place)
        used = {s for n in self.names for c in state.observed.get(n, ()) for s in c.guard}
        domains = {s.name: s.domain for s in self.product.sensors if s.name in used}
        if _size(domains) > MOST_VALUATIONS:
            raise FormulaError(f"{self.formula} depends on too many sensors at once")
        found: Guard | None = None
        for values in itertools.product(*domains.values()):
            valuation = dict(zip(domains, values, strict=True))
            step = state.label(valuation, self.names)
            for atom in self.atoms:
                self._seen.setdefault(atom, set()).add(evaluate(atom, [step], 0)[0])
            if found is None and not evaluate(self.formula, [step], 0)[0]:
                found = valuation
        return found


def _frozen(cases: Sequence[Case]) -> Hashable:
    return frozenset((frozenset(c.guard.items()), c.value) for c in cases)


def _size(domains: Mapping[str, Sequence[Scalar]]) -> int:
    size = 1
    for domain in domains.values():
        size *= len(domain)
    return size
