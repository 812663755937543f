"""Synthesis: can some plan keep a contract whatever the sensors show, and which one?"""

from vaso.synthesis.counterplay import CounterPlay, CounterStep
from vaso.synthesis.realizability import realizability
from vaso.synthesis.refinement import Refinement
from vaso.synthesis.result import Outside, Realizability
from vaso.synthesis.solver import is_installed

__all__ = [
    "CounterPlay",
    "CounterStep",
    "Outside",
    "Realizability",
    "Refinement",
    "is_installed",
    "realizability",
]
