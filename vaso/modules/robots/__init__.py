"""Adapters of real robots. Everything is imported on first use: each needs an extra of its own."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

_EXPORTS = {
    "JackalROS": "vaso.modules.robots.jackal",
    "PX4Mavlink": "vaso.modules.robots.px4",
    "RobotTools": "vaso.modules.robots.tools",
    "get_robot": "vaso.modules.robots.opening",
}

__all__ = ["JackalROS", "PX4Mavlink", "RobotTools", "get_robot"]

if TYPE_CHECKING:
    from vaso.modules.robots.jackal import JackalROS
    from vaso.modules.robots.opening import get_robot
    from vaso.modules.robots.px4 import PX4Mavlink
    from vaso.modules.robots.tools import RobotTools


def __getattr__(name: str) -> Any:
    if name in _EXPORTS:
        return getattr(import_module(_EXPORTS[name]), name)
    raise AttributeError(f"module 'vaso.modules.robots' has no attribute {name!r}")
