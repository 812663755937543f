"""Modules that write skills and plans: with a language model (dspy) and without one.

The dspy modules are imported on first use, so that the symbolic planner needs no framework.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

_EXPORTS = {
    "EditModel": "vaso.modules.edit_model",
    "PlanWriter": "vaso.modules.plan_writer",
    "Planner": "vaso.modules.planner",
    "SkillProgram": "vaso.modules.skill_program",
    "SkillRouter": "vaso.modules.routing",
    "SkillWriter": "vaso.modules.skill_writer",
    "SymbolicPlanner": "vaso.modules.symbolic",
    "read_quantities": "vaso.modules.quantities",
    "skill_tool": "vaso.modules.tools",
    "verifier_metric": "vaso.modules.metric",
    "verify_tool": "vaso.modules.tools",
}

__all__ = [
    "EditModel",
    "PlanWriter",
    "Planner",
    "SkillProgram",
    "SkillRouter",
    "SkillWriter",
    "SymbolicPlanner",
    "read_quantities",
    "skill_tool",
    "verifier_metric",
    "verify_tool",
]

if TYPE_CHECKING:
    from vaso.modules.edit_model import EditModel
    from vaso.modules.metric import verifier_metric
    from vaso.modules.plan_writer import PlanWriter
    from vaso.modules.planner import Planner
    from vaso.modules.quantities import read_quantities
    from vaso.modules.routing import SkillRouter
    from vaso.modules.skill_program import SkillProgram
    from vaso.modules.skill_writer import SkillWriter
    from vaso.modules.symbolic import SymbolicPlanner
    from vaso.modules.tools import skill_tool, verify_tool


def __getattr__(name: str) -> Any:
    if name in _EXPORTS:
        return getattr(import_module(_EXPORTS[name]), name)
    raise AttributeError(f"module 'vaso.modules' has no attribute {name!r}")
