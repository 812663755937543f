"""Why the shield has replaced a command, in words for the log and for the plan."""

from __future__ import annotations

from collections.abc import Sequence

from vaso.dynamics.rules import names_in
from vaso.ltl import Comparison
from vaso.monitoring.forecast import Phase
from vaso.monitoring.guarded import Guarded
from vaso.platforms import Issued

__all__ = ["reason_for"]


def reason_for(
    guarded: Guarded, phases: Sequence[Phase], sent: Issued, remaining: Sequence[str]
) -> str:
    """Why a command was replaced.

    Args:
        guarded: The rule.
        phases: What the command would lead to.
        sent: What is sent instead.
        remaining: Rules that may be lost even so.
    """
    why = f"it could break {guarded.rule.text}{_because(guarded, phases)}; {sent} is sent instead"
    if remaining:
        why += f", though even that may break {' and '.join(remaining)}"
    return why


def _because(guarded: Guarded, phases: Sequence[Phase]) -> str:
    told = [_number(atom, phases, index) for atom, index in guarded.troubles(phases)]
    if told:
        return ", because " + " and ".join(told)
    asks = " and ".join(map(str, guarded.asks))
    return f", which asks for {asks} now" if asks else ""


def _number(atom: Comparison, phases: Sequence[Phase], index: int) -> str:
    bounds = phases[index].bounds
    values = [f"{n} may come to {_extreme(atom, bounds[n]):.4g}" for n in sorted(names_in(atom))]
    when = "" if index == 0 else " before the robot is at rest again"
    return " and ".join(values) + when


def _extreme(atom: Comparison, bounds: tuple[float, float]) -> float:
    return bounds[0] if atom.op in (">", ">=") else bounds[1]
