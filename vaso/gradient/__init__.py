"""Textual gradients: from counterexample to feedback, and to a verified repair."""

from vaso.gradient.blame import Blame, blame
from vaso.gradient.build import blames, textual_gradient
from vaso.gradient.edits import propose_edits
from vaso.gradient.model import PASS_TEXT, Edit, Level, TextualGradient
from vaso.gradient.repair import find_repair
from vaso.gradient.trace import trace_table

__all__ = [
    "PASS_TEXT",
    "Blame",
    "Edit",
    "Level",
    "TextualGradient",
    "blame",
    "blames",
    "find_repair",
    "propose_edits",
    "textual_gradient",
    "trace_table",
]
