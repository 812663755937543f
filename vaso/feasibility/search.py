"""Deciding conjunctions of formulas, numeric comparisons included, and shrinking conflicts."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from vaso.feasibility.asking import ask
from vaso.feasibility.universal import Universe, components
from vaso.feasibility.witness import Witness
from vaso.ltl import Formula, simplify
from vaso.satisfiability import Lasso, conjuncts
from vaso.verifiers.engine import SMVEngine

__all__ = ["Core", "Outcome", "Search"]

MAX_ROUNDS = 200
_SHARE = 0.2  # of the time left, for one question about a part of a conflict


@dataclass(frozen=True, slots=True)
class Outcome:
    """The answer for a conjunction.

    Attributes:
        sat: True, False or None (not decided).
        witness: For True, where it could be re-evaluated.
        reason: Why it is not decided, or why there is no witness.
        conflict: For False: indices of formulas that conflict already without the others.
    """

    sat: bool | None
    witness: Witness | None = None
    reason: str = ""
    conflict: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Core:
    """A conflicting subset.

    Attributes:
        indices: Indices of the formulas, ascending.
        minimal: True when it is known that no proper part of it conflicts.
        reason: Why that is not known.
    """

    indices: tuple[int, ...]
    minimal: bool = True
    reason: str = ""


class Search:
    """Decides conjunctions within one time limit, each only once.

    Args:
        exclusions: Groups of propositions of which at most one holds in any step.
        timeout: Seconds for everything that is asked of this object.
        engine: A model checker that decides instead of VASO's own procedure.
    """

    def __init__(
        self,
        *,
        exclusions: Iterable[Iterable[str]] = (),
        timeout: float = 10.0,
        engine: SMVEngine | None = None,
    ) -> None:
        self._exclusions = [tuple(group) for group in exclusions]
        self._deadline = time.monotonic() + timeout
        self._engine = engine
        self._known: dict[frozenset[Formula], Outcome] = {}

    def decide(self, formulas: Sequence[Formula], *, share: float = 1.0) -> Outcome:
        """Decide whether some behaviour satisfies all the formulas.

        Args:
            formulas: The formulas.
            share: Part of the time left that this question may take.

        Raises:
            FormulaError: A name is used both as a truth value and as a number.
        """
        Universe.of(formulas, self._exclusions)
        pieces = [(i, p) for i, f in enumerate(formulas) for p in conjuncts(simplify(f))]
        universe = Universe.of([p for _, p in pieces], self._exclusions)
        until = self._deadline - (1 - share) * max(0.0, self._deadline - time.monotonic())
        outcomes = []
        for group in components([p for _, p in pieces], universe):
            outcome = self._group([pieces[k][1] for k in group], until)
            if outcome.sat is False:
                return replace(outcome, conflict=tuple(sorted({pieces[k][0] for k in group})))
            outcomes.append(outcome)
        return _joined(outcomes, formulas)

    def core(
        self,
        formulas: Sequence[Formula],
        *,
        order: Iterable[int] = (),
        fixed: Sequence[Formula] = (),
    ) -> Core:
        """Shrink a conflicting conjunction by leaving out formulas, many at a time where possible.

        The answer is that of leaving out one after the other.

        Args:
            formulas: Formulas that conflict, together with ``fixed``.
            order: Indices in the order in which to try to leave them out; the others stay.
            fixed: Formulas that always stay, and are not part of the answer.
        """
        kept = self._conflicting(formulas, list(range(len(formulas))), fixed)
        undecided = 0
        pending = [list(order)]
        while pending:
            out = [i for i in pending.pop() if i in kept]
            if not out:
                continue
            rest = [i for i in kept if i not in out]
            outcome = self.decide([*(formulas[i] for i in rest), *fixed], share=_SHARE)
            if outcome.sat is False:
                kept = self._conflicting(formulas, rest, fixed)
            elif len(out) > 1:
                pending += [out[len(out) // 2 :], out[: len(out) // 2]]
            else:
                undecided += outcome.sat is None
        reason = "the conflicting subset may not be the smallest: out of time" if undecided else ""
        return Core(tuple(kept), not undecided, reason)

    def _conflicting(
        self, formulas: Sequence[Formula], kept: list[int], fixed: Sequence[Formula]
    ) -> list[int]:
        outcome = self.decide([*(formulas[i] for i in kept), *fixed])
        return [kept[k] for k in outcome.conflict if k < len(kept)]

    def _group(self, formulas: Sequence[Formula], until: float) -> Outcome:
        key = frozenset(formulas)
        if key not in self._known or self._known[key].sat is None:
            self._known[key] = self._solve(formulas, until)
        return self._known[key]

    def _solve(self, formulas: Sequence[Formula], until: float) -> Outcome:
        universe = Universe.of(formulas, self._exclusions)
        for _ in range(MAX_ROUNDS):
            outcome, universe = self._attempt(universe, formulas, until)
            if outcome is not None:
                return outcome
        return Outcome(None, reason="the comparisons have too many combinations")

    def _attempt(
        self, universe: Universe, formulas: Sequence[Formula], until: float
    ) -> tuple[Outcome | None, Universe]:
        """Ask once; a behaviour with impossible numbers only refines the universe."""
        left = until - time.monotonic()
        if left <= 0:
            return Outcome(None, reason="out of time"), universe
        answer = ask(universe, formulas, timeout=left, engine=self._engine)
        if not answer.sat:
            return Outcome(answer.sat, reason=answer.reason), universe
        if answer.lasso is None:
            known = True if universe.exact else None
            return Outcome(known, reason=answer.reason or "no witness was given"), universe
        witness = _decoded(universe, answer.lasso)
        if isinstance(witness, Universe):
            return None, witness
        return _confirmed(witness, formulas, universe), universe


def _decoded(universe: Universe, lasso: Lasso) -> Witness | Universe:
    """The witness in the terms of the formulas, or a universe without its impossible numbers."""
    steps = []
    for values in lasso.steps:
        decoded = universe.decode(values)
        if decoded is None:
            return universe.blocking(universe.conflict(universe.regions(values)))
        steps.append(decoded)
    return Witness(tuple(steps), lasso.loop_start)


def _confirmed(witness: Witness, formulas: Sequence[Formula], universe: Universe) -> Outcome:
    full = witness.covering(formulas)
    if full.satisfies(formulas):
        return Outcome(True, full)
    if universe.linear:
        return Outcome(None, reason="the witness does not stand up to evaluation")
    return Outcome(None, reason="products or quotients of numbers are not decided")


def _joined(outcomes: Sequence[Outcome], formulas: Sequence[Formula]) -> Outcome:
    undecided = next((o for o in outcomes if o.sat is None), None)
    if undecided is not None:
        return undecided
    witness: Witness | None = Witness(({},), 0)
    for outcome in outcomes:
        both = witness is not None and outcome.witness is not None
        witness = witness.beside(outcome.witness) if both else None  # type: ignore[union-attr,arg-type]
    if witness is None:
        missing = next((o.reason for o in outcomes if o.witness is None), "")
        return Outcome(True, reason=missing or "the witness is too long to show")
    full = witness.covering(formulas)
    if not full.satisfies(formulas):
        return Outcome(None, reason="the witness does not stand up to evaluation")
    return Outcome(True, full)
