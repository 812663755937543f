"""Is there a behaviour that satisfies all the formulas?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from vaso.ltl import FALSE, Formula, propositions
from vaso.satisfiability.clock import Clock, OutOfTimeError
from vaso.satisfiability.explore import Lasso, find_behaviour
from vaso.satisfiability.race import Rival
from vaso.satisfiability.rewrite import Rewritten, rewrite
from vaso.satisfiability.tableau import Tableau

__all__ = ["Decision", "decide"]


@dataclass(frozen=True, slots=True)
class Decision:
    """The answer.

    Attributes:
        sat: True, False or None (not decided).
        lasso: For True, a behaviour: a value for every proposition in every step.
        reason: Why it is not decided.
        method: What found the answer: ``rewriting``, ``search``, or ``model checker``.
    """

    sat: bool | None
    lasso: Lasso | None = None
    reason: str = ""
    method: str = ""


def decide(formulas: Sequence[Formula], *, timeout: float = 10.0, race: bool = True) -> Decision:
    """Decide a conjunction of formulas without numeric comparisons.

    The formulas are made smaller, then a SAT solver searches for a behaviour step by step, learning
    which duties cannot be met. What this does not decide in a second or two also goes to a model
    checker in a second process, and the first answer counts.

    Args:
        formulas: The conjuncts.
        timeout: Seconds.
        race: Whether the model checker may be asked as well.

    Returns:
        The answer. The lasso has not been checked: whoever reports it evaluates it first.
    """
    smaller = rewrite(formulas)
    if FALSE in smaller.formulas:
        return Decision(False, method="rewriting")
    names = frozenset[str]().union(*map(propositions, formulas))
    default = {**dict.fromkeys(sorted(names), False), **smaller.fixed}
    return _complete(_solve(smaller, timeout, race), default)


def _solve(question: Rewritten, timeout: float, race: bool) -> Decision:
    rival = Rival(question.formulas, timeout)
    clock = Clock(timeout, rival.has_won if race else None)
    try:
        found = find_behaviour(Tableau(question.formulas), clock)
    except OutOfTimeError:
        if not rival.has_won():
            return Decision(None, reason="out of time")
        return Decision(rival.sat, rival.lasso, method="model checker")
    finally:
        rival.close()
    return Decision(found is not None, found, method="search")


def _complete(decision: Decision, default: Mapping[str, bool]) -> Decision:
    """Give every proposition a value, those that rewriting removed as well."""
    if decision.lasso is None:
        return decision
    steps = tuple({**default, **step} for step in decision.lasso.steps)
    lasso = Lasso(steps, decision.lasso.loop_start)
    return Decision(decision.sat, lasso, decision.reason, decision.method)
