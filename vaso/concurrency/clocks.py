"""Rules of one robot among several: counted in its own steps.

Where robots do not step together, "next" in a rule of one robot means its own next step. A rule is
rewritten so that it looks only at the steps in which the robot's clock ticks: the clocked semantics
of IEEE 1850 (PSL), ``f @ clock``, with past operators treated alike.
"""

from __future__ import annotations

from vaso.ltl import Binary, Formula, Proposition, Unary, fold, implies, negate
from vaso.ltl.traverse import rebuild

__all__ = ["clocked"]


def clocked(formula: Formula, clock: Proposition) -> Formula:
    """The formula on the subsequence of steps in which the clock ticks.

    Args:
        formula: The formula.
        clock: True in the steps that count.

    Returns:
        A formula that is true where the clock ticks sometime and ``formula`` is true on the steps
        in which it does. Where the clock stops for ever, "next" asks for a tick that does not come
        and is false.
    """
    return _first(fold(formula, lambda node, parts: _combine(node, parts, clock)), clock)


def _first(formula: Formula, clock: Proposition) -> Formula:
    """At the first tick from here on."""
    return Binary("U", negate(clock), Binary("&", clock, formula))


def _last(formula: Formula, clock: Proposition) -> Formula:
    """At the last tick up to here."""
    return Binary("S", negate(clock), Binary("&", clock, formula))


def _combine(node: Formula, parts: tuple[Formula, ...], clock: Proposition) -> Formula:
    some, every = [Binary("&", clock, p) for p in parts], [implies(clock, p) for p in parts]
    match node:
        case Unary("X", _):
            return Unary("X", _first(parts[0], clock))
        case Unary("Y", _):
            return Unary("Y", _last(parts[0], clock))
        case Unary("Z", _):
            return negate(Unary("Y", _last(negate(parts[0]), clock)))
        case Unary("F" | "O" as op, _):
            return Unary(op, some[0])
        case Unary("G" | "H" as op, _):
            return Unary(op, every[0])
        case Binary("U" | "W" | "S" as op, _, _):
            return Binary(op, every[0], some[1])
        case Binary("V" | "T" as op, _, _):
            return Binary(op, some[0], every[1])
    return rebuild(node, parts)
