"""Why a rule may hold without saying anything about a plan.

Two cases that people overlook, and that the form of a rule shows: its trigger never happens, or
what it promises is true before the plan has done anything. (For the general problem see Beer et
al., Efficient Detection of Vacuity in Temporal Model Checking, 2001.)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from vaso.ltl import Binary, Constant, Formula, Unary, always, negate

__all__ = ["Probe", "probes"]


@dataclass(frozen=True, slots=True)
class Probe:
    """A formula whose truth on every run makes a rule vacuous.

    Attributes:
        formula: The formula.
        reason: What that means, for the reader.
    """

    formula: Formula
    reason: str


def probes(rule: Formula) -> list[Probe]:
    """The probes of a rule: for each trigger, and for each promise outside of ``G``."""
    return list(_probes(rule, None))


def _probes(rule: Formula, around: Callable[[Formula], Formula] | None) -> Iterator[Probe]:
    match rule:
        case Binary("&", left, right):
            yield from _probes(left, around)
            yield from _probes(right, around)
        case Unary("G", operand):
            yield from _probes(operand, always)
        case Binary("->", trigger, promise):
            if not isinstance(trigger, Constant):
                never = negate(trigger)
                text = f"its trigger never happens: {trigger}"
                yield Probe(around(never) if around else never, text)
            if around is None:
                yield from _kept_at_once(promise)
        case _ if around is None:
            yield from _kept_at_once(rule)


def _kept_at_once(promise: Formula) -> Iterator[Probe]:
    match promise:
        case Unary("F", goal) | Binary("U", _, goal) if not isinstance(goal, Constant):
            yield Probe(goal, f"already true in the first state, before the plan acts: {goal}")
