"""Transition systems as text: NuSMV, Graphviz and JSON."""

from vaso.plan.export.dot import to_dot
from vaso.plan.export.plain import from_json, to_json
from vaso.plan.export.smv import SmvModel, to_smv

__all__ = ["SmvModel", "from_json", "to_dot", "to_json", "to_smv"]
