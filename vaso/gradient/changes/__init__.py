"""Elementary changes of a plan, one family a module."""

from vaso.gradient.changes.program import Change, Patch, Program
from vaso.gradient.changes.vocabulary import Vocabulary

__all__ = ["Change", "Patch", "Program", "Vocabulary"]
