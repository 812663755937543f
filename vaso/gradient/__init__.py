"""Textual gradients: from counterexample to feedback, and to a verified repair."""

from vaso.gradient.build import textual_gradient
from vaso.gradient.model import PASS_TEXT, Edit, Level, TextualGradient

__all__ = ["PASS_TEXT", "Edit", "Level", "TextualGradient", "textual_gradient"]
