"""Runs of a transition system: following sensor values, replaying, and evaluating formulas.

The system is deterministic once the sensors are given, so a run is fixed by what the sensors say.
That makes a verifier's counterexample checkable without trusting the verifier: take its sensor
values, follow the system, and evaluate the formula on what comes out.
"""

from __future__ import annotations

from collections.abc import Sequence

from vaso.ltl import Formula, holds
from vaso.plan.atoms import names_of
from vaso.plan.transition_system import Guard, Label, Scalar, TransitionSystem
from vaso.verifiers.base import Lasso

__all__ = ["confirmed", "default_values", "follow", "labels_along", "objection", "violates"]


def default_values(system: TransitionSystem) -> dict[str, Scalar]:
    """The dullest valuation: False for every sensor that can be False, else its first value."""
    return {s.name: False if False in s.domain else s.domain[0] for s in system.sensors}


def follow(
    system: TransitionSystem,
    prefix: Sequence[Guard],
    loop: Sequence[Guard],
    *,
    limit: int | None = None,
) -> Lasso | None:
    """Run a system under the sensor values ``prefix`` and then ``loop`` for ever.

    The run closes when the system is in the same control state at the same place of ``loop``
    again; until then the loop is unrolled. Sensors without a value get the default.

    Args:
        system: A total system.
        prefix: Sensor values of the first steps.
        loop: Sensor values that then repeat; not empty.
        limit: Longest run to look at. Without it the run always closes.

    Returns:
        The run, in its shortest form; None if it does not close within the limit.
    """
    usual = default_values(system)
    run: list[tuple[int, Guard]] = []
    seen: dict[tuple[int, int], int] = {}
    state = place = 0
    while limit is None or len(run) < limit:
        turning = place - len(prefix)
        if turning >= 0:
            here = (state, turning % len(loop))
            if here in seen:
                return tidy(Lasso(tuple(run), seen[here]))
            seen[here] = len(run)
        values = prefix[place] if turning < 0 else loop[turning % len(loop)]
        run.append((state, {**usual, **values}))
        state = system.step(*run[-1]).target
        place += 1
    return None


def tidy(lasso: Lasso) -> Lasso:
    """The shortest way to write the same infinite run: no repeated turns, no rolled-out prefix."""
    prefix, loop = list(lasso.run[: lasso.loop_start]), list(lasso.run[lasso.loop_start :])
    loop = loop[: _period(loop)]
    while prefix and prefix[-1] == loop[-1]:
        prefix.pop()
        loop = [loop[-1], *loop[:-1]]
    return Lasso((*prefix, *loop), len(prefix))


def _period(loop: Sequence[tuple[int, Guard]]) -> int:
    size = len(loop)
    for period in (p for p in range(1, size) if size % p == 0):
        if all(loop[i] == loop[i - period] for i in range(period, size)):
            return period
    return size


def labels_along(
    system: TransitionSystem, lasso: Lasso, formula: Formula
) -> list[dict[str, Label]]:
    """The value of each proposition of the formula at every place of a run."""
    names = names_of(formula)
    return [system.states[state].label(valuation, names) for state, valuation in lasso.run]


def violates(system: TransitionSystem, lasso: Lasso, formula: Formula) -> bool:
    """True when the formula is false on the run."""
    return not holds(formula, labels_along(system, lasso, formula), lasso.loop_start)


def objection(system: TransitionSystem, lasso: Lasso, formula: Formula) -> str:
    """Why a run is not a counterexample to the formula, or an empty string if it is one."""
    if not lasso.run or lasso.run[0][0] != 0:
        return "it does not start in the initial state"
    after = [*range(1, len(lasso.run)), lasso.loop_start]
    for place, (state, valuation) in enumerate(lasso.run):
        edge = system.step(state, valuation)
        if edge.target != lasso.run[after[place]][0]:
            return f"step {place} of it cannot be replayed on the plan"
    return "" if violates(system, lasso, formula) else "the formula is true on it"


def confirmed(
    system: TransitionSystem,
    word: tuple[Sequence[Guard], Sequence[Guard]],
    formula: Formula,
) -> Lasso | None:
    """The run along sensor values (prefix and loop), if it really violates the formula."""
    lasso = follow(system, *word)
    return None if lasso is None or objection(system, lasso, formula) else lasso
