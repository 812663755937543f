"""Sound verdicts on plans that could not be explored to the end.

In a *cut* state nothing is known: not what is true there, not what follows. Two readings of a
formula bound the truth. The weak one takes every literal to be true in cut states; a run that
violates it violates the formula whatever really happens there. The strong one takes every literal
to be false; where it holds, so does the formula. This is the weak and strong truncated semantics
of Eisner et al. (Reasoning with Temporal Logic on Truncated Paths, 2003), put into the formula.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

from vaso.ltl import Binary, Comparison, Constant, Formula, Proposition, Unary, fold, negate, nnf
from vaso.ltl.traverse import rebuild
from vaso.plan.transition_system import Cut, TransitionSystem

__all__ = ["CUT", "explain", "mark", "strengthen", "weaken"]

CUT = Proposition("__cut__")
"""True in cut states. Names that begin with two underscores are not open to plans."""

_Pair: TypeAlias = tuple[Formula, Formula]
"""A subformula with its literals changed, and as it was."""


def mark(system: TransitionSystem) -> TransitionSystem:
    """Label every state with whether it is a cut."""
    states = (s.relabelled({**s.labels, CUT.name: s.cut}, s.observed) for s in system.states)
    return replace(system, states=tuple(states))


def weaken(formula: Formula) -> Formula:
    """The formula with every literal true in cut states."""
    return _with_literals(formula, lambda literal: Binary("|", literal, CUT))


def strengthen(formula: Formula) -> Formula:
    """The formula with every literal false in cut states."""
    return _with_literals(formula, lambda literal: Binary("&", literal, negate(CUT)))


def explain(cut: Cut | None) -> str:
    """Why some rule stays undecided."""
    if cut is None:
        return "the plan was not explored completely"
    place = f" (line {cut.line})" if cut.line else ""
    return f"explored up to step {max(0, cut.depth)}: {cut.reason}{place}"


def _with_literals(formula: Formula, change: Callable[[Formula], Formula]) -> Formula:
    def combine(node: Formula, parts: tuple[_Pair, ...]) -> _Pair:
        match node:
            case Constant():
                return node, node
            case Proposition() | Comparison():
                return change(node), node
            case Unary("!", _):
                literal = negate(parts[0][1])
                return change(literal), literal
        return rebuild(node, tuple(changed for changed, _ in parts)), node

    return fold(nnf(formula), combine)[0]
