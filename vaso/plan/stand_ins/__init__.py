"""Stand-ins for what plans use and the sandbox does not know. All keep the plan's line numbers."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from vaso.plan.rewrite import Edit
from vaso.plan.stand_ins.deletions import deletion_edits
from vaso.plan.stand_ins.enums import enum_edits, enum_prelude
from vaso.plan.stand_ins.exceptions import exception_edits
from vaso.plan.stand_ins.imports import import_prelude, name_edits
from vaso.plan.stand_ins.methods import method_edits
from vaso.plan.stand_ins.modules import module_edits, module_prelude, replaced_modules
from vaso.plan.stand_ins.properties import property_edits
from vaso.plan.stand_ins.tuples import tuple_edits, tuple_prelude

__all__ = ["replaced_modules", "stand_in_edits", "stand_in_prelude"]


def stand_in_edits(source: str, tree: ast.Module, name: str) -> Iterator[Edit]:
    """The changes of a plan's text.

    Args:
        source: The plan's text.
        tree: Its syntax tree.
        name: How messages call it.

    Raises:
        UnsupportedPlanError: The plan uses something otherwise than its stand-in allows.
    """
    yield from enum_edits(tree, name)
    yield from exception_edits(tree)
    yield from module_edits(tree)
    yield from name_edits(tree)
    yield from tuple_edits(tree)
    yield from property_edits(source, tree)
    yield from method_edits(source, tree)
    yield from deletion_edits(source, tree)


def stand_in_prelude(tree: ast.Module) -> str:
    """What must run before the plan."""
    return enum_prelude(tree) + module_prelude(tree) + tuple_prelude(tree) + import_prelude(tree)
