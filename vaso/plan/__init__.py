"""Plans: sandboxed execution, exploration into a TransitionSystem, export."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

_EXPORTS = {
    "Plan": "vaso.plan.model",
    "TransitionSystem": "vaso.plan.transition_system",
    "State": "vaso.plan.transition_system",
    "Edge": "vaso.plan.transition_system",
    "Sensor": "vaso.plan.transition_system",
    "Case": "vaso.plan.transition_system",
    "Cut": "vaso.plan.transition_system",
    "Budget": "vaso.plan.explore",
    "compile_plan": "vaso.plan.explore",
    "to_smv": "vaso.plan.export",
    "to_dot": "vaso.plan.export",
    "to_json": "vaso.plan.export",
}

__all__ = [
    "Budget",
    "Case",
    "Cut",
    "Edge",
    "Plan",
    "Sensor",
    "State",
    "TransitionSystem",
    "compile_plan",
    "to_dot",
    "to_json",
    "to_smv",
]

if TYPE_CHECKING:
    from vaso.plan.explore import Budget, compile_plan
    from vaso.plan.export import to_dot, to_json, to_smv
    from vaso.plan.model import Plan
    from vaso.plan.transition_system import Case, Cut, Edge, Sensor, State, TransitionSystem


def __getattr__(name: str) -> Any:
    if name in _EXPORTS:
        return getattr(import_module(_EXPORTS[name]), name)
    raise AttributeError(f"module 'vaso.plan' has no attribute {name!r}")
