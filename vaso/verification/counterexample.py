"""From a run of the automaton to a counterexample that a person can read."""

from __future__ import annotations

from collections.abc import Sequence

from vaso.ltl import Formula, Unary, evaluate, past_depth, subformulas
from vaso.plan.transition_system import Edge, Label, TransitionSystem
from vaso.verdict import Counterexample, Step
from vaso.verification.cuts import CUT, weaken
from vaso.verifiers.base import Lasso

__all__ = ["decided_at", "explain_run"]

_STOPPED = "exploration stopped here; the rule is violated whatever follows"


def explain_run(system: TransitionSystem, lasso: Lasso, formula: Formula) -> Counterexample:
    """Describe a violating run step by step.

    Args:
        system: The system, as it was explored.
        lasso: A run that violates the formula.
        formula: The violated formula.
    """
    place = decided_at(system, lasso, formula)
    lasso = _rolled(lasso, 0 if place is None else place + 1)
    return Counterexample(
        formula=str(formula),
        steps=tuple(_steps(system, lasso)),
        loop_start=lasso.loop_start,
        decided_at=place,
        dt=system.dt,
    )


def decided_at(system: TransitionSystem, lasso: Lasso, formula: Formula) -> int | None:
    """The first step after which nothing can repair the violation; None where repair is possible.

    The steps after it are taken to be unknown (see :mod:`vaso.verification.cuts`): the formula is
    lost for good when even its weak reading is false. The place may lie in a later turn of the
    loop.
    """
    weak = weaken(formula)
    loop = len(lasso.run) - lasso.loop_start
    longest = len(lasso.run) + loop * (1 + past_depth(formula)) + _steps_ahead(formula)
    labels = [
        {**system.label(state, valuation), CUT.name: system.states[state].cut}
        for state, valuation in _rolled(lasso, longest).run
    ]
    if not _is_lost(weak, labels):
        return None
    lost, possible = len(labels), 0
    while lost - possible > 1:
        middle = (lost + possible) // 2
        lost, possible = (middle, possible) if _is_lost(weak, labels[:middle]) else (lost, middle)
    return lost - 1


def _is_lost(weak: Formula, labels: Sequence[dict[str, Label]]) -> bool:
    unknown = {**labels[-1], CUT.name: True}
    return not evaluate(weak, [*labels, unknown], len(labels))[0]


def _steps_ahead(formula: Formula) -> int:
    return sum(isinstance(f, Unary) and f.op == "X" for f in subformulas(formula))


def _rolled(lasso: Lasso, length: int) -> Lasso:
    """The same run, with the loop rolled out until there are at least ``length`` steps."""
    run, start = list(lasso.run), lasso.loop_start
    while len(run) < length:
        run.append(run[start])
        start += 1
    return Lasso(tuple(run), start)


def _steps(system: TransitionSystem, lasso: Lasso) -> list[Step]:
    steps: list[Step] = []
    before: Edge | None = None
    for index, (number, valuation) in enumerate(lasso.run):
        state, after = system.states[number], system.step(number, valuation)
        steps.append(
            Step(
                index=index,
                state=number,
                command=state.command,
                api=state.api,
                line=(before.line if before else None) or state.line,
                sensors=valuation,
                labels=system.label(number, valuation),
                reads=after.reads,
                note=_STOPPED if state.cut else state.note,
            )
        )
        before = after
    return steps
