"""From a run of the product to a counterexample that shows every plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from vaso.concurrency.product import Product
from vaso.concurrency.replay import Replay, replay
from vaso.concurrency.result import Doing, JointCounterexample
from vaso.ltl import Formula
from vaso.plan.transition_system import Edge, State
from vaso.verdict import Step
from vaso.verification.counterexample import explain_run
from vaso.verifiers.base import Lasso
from vaso.verifiers.runs import violates

__all__ = ["explain_jointly"]


def explain_jointly(product: Product, lasso: Lasso, formula: Formula) -> JointCounterexample | None:
    """Describe a violating run step by step, for each member.

    Args:
        product: The product of the members as they were explored.
        lasso: A run of the same product or of one that is bisimilar to it.
        formula: The violated formula.

    Returns:
        The counterexample; None where the run cannot be replayed or does not violate the formula.
    """
    run = replay(product, lasso)
    if run is None or not violates(run.system, run.lasso, formula):
        return None
    plain = explain_run(run.system, run.lasso, formula)
    doing = [_doing(product, run, index) for index in range(len(plain.steps))]
    return JointCounterexample(
        formula=plain.formula,
        steps=tuple(_told(product.names, s, d) for s, d in zip(plain.steps, doing, strict=True)),
        loop_start=plain.loop_start,
        decided_at=plain.decided_at,
        dt=plain.dt,
        members=tuple(product.names),
        doing=tuple(doing),
        timed=product.schedule.dt is not None,
    )


def _doing(product: Product, run: Replay, index: int) -> tuple[Doing, ...]:
    """What each member does in a step of the run, rolled out."""
    here = run.places[_position(run, index)]
    after = run.moves[_position(run, index)].taken
    return tuple(
        _member(state, number, _entered(run, index, i), after[i], moved=_moved(run, index, i))
        for i, (state, number) in enumerate(zip(product.here(here), here.states, strict=True))
    )


def _position(run: Replay, index: int) -> int:
    count, start = len(run.places), run.lasso.loop_start
    return index if index < count else start + (index - count) % (count - start)


def _entered(run: Replay, index: int, member: int) -> Edge | None:
    """The edge by which a member came to where it is in a step."""
    for before in range(index - 1, -1, -1):
        edge = run.moves[_position(run, before)].taken[member]
        if edge is not None:
            return edge
    return None


def _moved(run: Replay, index: int, member: int) -> bool:
    return index > 0 and run.moves[_position(run, index - 1)].taken[member] is not None


def _member(
    state: State, number: int, entered: Edge | None, after: Edge | None, *, moved: bool
) -> Doing:
    return Doing(
        command=state.command,
        api=state.api,
        line=(entered.line if entered else None) or state.line,
        plan=state.plan,
        reads=after.reads if after else (),
        note="exploration stopped here" if state.cut else state.note,
        moved=moved,
        state=number,
    )


def _told(names: Sequence[str], step: Step, doing: Sequence[Doing]) -> Step:
    """The joint step, for views that know of one robot only."""
    pairs = list(zip(names, doing, strict=True))
    reads = tuple((f"{n}.{read}", line) for n, d in pairs for read, line in d.reads)
    return replace(step, api=" · ".join(f"{n}: {_call(d)}" for n, d in pairs), reads=reads)


def _call(doing: Doing) -> str:
    line = f" (line {doing.line})" if doing.line else ""
    return f"{doing.api or doing.command}{line}"
