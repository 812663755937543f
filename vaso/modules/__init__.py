"""Modules that write skills and plans: with a language model (dspy) and without one.

The dspy modules are imported on first use, so that the symbolic planner needs no framework.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

_EXPORTS = {
    "EditModel": "vaso.modules.edit_model",
    "Planner": "vaso.modules.planner",
    "SkillWriter": "vaso.modules.skill_writer",
    "SymbolicPlanner": "vaso.modules.symbolic",
    "read_quantities": "vaso.modules.quantities",
}

__all__ = ["EditModel", "Planner", "SkillWriter", "SymbolicPlanner", "read_quantities"]

if TYPE_CHECKING:
    from vaso.modules.edit_model import EditModel
    from vaso.modules.planner import Planner
    from vaso.modules.quantities import read_quantities
    from vaso.modules.skill_writer import SkillWriter
    from vaso.modules.symbolic import SymbolicPlanner


def __getattr__(name: str) -> Any:
    if name in _EXPORTS:
        return getattr(import_module(_EXPORTS[name]), name)
    raise AttributeError(f"module 'vaso.modules' has no attribute {name!r}")
