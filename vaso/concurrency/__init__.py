"""Several plans at the same time: on several robots, or on one robot that they take turns with."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

_EXPORTS = {
    "compose": "vaso.concurrency.composing",
    "CompositionResult": "vaso.concurrency.result",
    "JointCounterexample": "vaso.concurrency.result",
    "Member": "vaso.concurrency.members",
    "Preemption": "vaso.concurrency.preemption",
    "preempt": "vaso.concurrency.preemption",
    "load_mission": "vaso.concurrency.mission",
    "Mission": "vaso.concurrency.mission",
}

__all__ = [
    "CompositionResult",
    "JointCounterexample",
    "Member",
    "Mission",
    "Preemption",
    "compose",
    "load_mission",
    "preempt",
]

if TYPE_CHECKING:
    from vaso.concurrency.composing import compose
    from vaso.concurrency.members import Member
    from vaso.concurrency.mission import Mission, load_mission
    from vaso.concurrency.preemption import Preemption, preempt
    from vaso.concurrency.result import CompositionResult, JointCounterexample


def __getattr__(name: str) -> Any:
    if name in _EXPORTS:
        return getattr(import_module(_EXPORTS[name]), name)
    raise AttributeError(f"module 'vaso.concurrency' has no attribute {name!r}")
