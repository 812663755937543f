"""Feasibility: satisfiability of formulas, and whether a skill's contract can be kept at all."""

from vaso.feasibility.check import check
from vaso.feasibility.conflict import Conflict
from vaso.feasibility.result import Exercise, FeasibilityResult
from vaso.feasibility.satisfiability import SatResult, satisfiable
from vaso.feasibility.witness import Witness

__all__ = [
    "Conflict",
    "Exercise",
    "FeasibilityResult",
    "SatResult",
    "Witness",
    "check",
    "satisfiable",
]
