"""Optimizers: they rewrite the texts of a skill until its plans are verified.

``optimize`` is the door. Behind it, every optimizer is a proposer of candidates; the shared loop
evaluates, accepts or reverts, keeps the budget, and writes checkpoints.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

_EXPORTS = {
    "Budget": "budget",
    "Case": "base",
    "DrivenOptimizer": "session",
    "Driver": "session",
    "EndOfRun": "budget",
    "Event": "events",
    "FieldLoss": "field",
    "Loss": "base",
    "LossValue": "base",
    "LoopOptimizer": "loop",
    "OptimizationResult": "result",
    "Optimizer": "base",
    "Parameters": "parameters",
    "Proposal": "base",
    "Proposer": "base",
    "RunStore": "store",
    "Session": "session",
    "SkillLoss": "loss",
    "Spent": "budget",
    "State": "base",
    "StepRecord": "result",
    "VASO": "teleprompter",
    "get_optimizer": "registry",
    "optimize": "run",
    "optimizers": "registry",
    "register_optimizer": "registry",
}

__all__ = [
    "VASO",
    "Budget",
    "Case",
    "DrivenOptimizer",
    "Driver",
    "EndOfRun",
    "Event",
    "FieldLoss",
    "LoopOptimizer",
    "Loss",
    "LossValue",
    "OptimizationResult",
    "Optimizer",
    "Parameters",
    "Proposal",
    "Proposer",
    "RunStore",
    "Session",
    "SkillLoss",
    "Spent",
    "State",
    "StepRecord",
    "get_optimizer",
    "optimize",
    "optimizers",
    "register_optimizer",
]

if TYPE_CHECKING:
    from vaso.optimizers.base import (
        Case,
        Loss,
        LossValue,
        Optimizer,
        Proposal,
        Proposer,
        State,
    )
    from vaso.optimizers.budget import Budget, EndOfRun, Spent
    from vaso.optimizers.events import Event
    from vaso.optimizers.field import FieldLoss
    from vaso.optimizers.loop import LoopOptimizer
    from vaso.optimizers.loss import SkillLoss
    from vaso.optimizers.parameters import Parameters
    from vaso.optimizers.registry import get_optimizer, optimizers, register_optimizer
    from vaso.optimizers.result import OptimizationResult, StepRecord
    from vaso.optimizers.run import optimize
    from vaso.optimizers.session import DrivenOptimizer, Driver, Session
    from vaso.optimizers.store import RunStore
    from vaso.optimizers.teleprompter import VASO


def __getattr__(name: str) -> Any:
    if name in _EXPORTS:
        return getattr(import_module(f"vaso.optimizers.{_EXPORTS[name]}"), name)
    raise AttributeError(f"module 'vaso.optimizers' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
