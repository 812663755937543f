"""One question to whoever decides: is there a behaviour in the universe?"""

from __future__ import annotations

from collections.abc import Sequence

from vaso.feasibility.universal import Universe
from vaso.ltl import Formula, always, conjunction, negate
from vaso.ltl.nusmv import to_nusmv
from vaso.satisfiability import Decision, Lasso, decide
from vaso.verifiers.engine import SMVEngine, SMVTrace

__all__ = ["ask"]


def ask(
    universe: Universe,
    formulas: Sequence[Formula],
    *,
    timeout: float,
    engine: SMVEngine | None = None,
) -> Decision:
    """Decide whether some behaviour in a universe satisfies all the formulas.

    Args:
        universe: What is possible in a state.
        formulas: Formulas over its names and numbers.
        timeout: Seconds.
        engine: A model checker to decide with; VASO's own procedure by default.

    Returns:
        The answer, with a lasso over the booleans of the universe's model.
    """
    encoded = [universe.encode(f) for f in formulas]
    if engine is None:
        return decide([*encoded, *map(always, universe.constraints())], timeout=timeout)
    spec = to_nusmv(negate(conjunction(encoded)), lambda name: name)
    answer = engine.check(universe.smv(), [spec], timeout=timeout, traces=True)[0]
    sat = None if answer.holds is None else not answer.holds
    return Decision(sat, _lasso(answer.trace), answer.reason, engine.name)


def _lasso(trace: SMVTrace | None) -> Lasso | None:
    if trace is None:
        return None
    steps = ({name: text == "TRUE" for name, text in s.values.items()} for s in trace.steps)
    return Lasso(tuple(steps), trace.loop_start)
