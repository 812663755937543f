"""What the stand-ins ask of a class's definition."""

from __future__ import annotations

import ast

__all__ = ["bases_of", "says_nothing"]


def bases_of(node: ast.ClassDef) -> list[str]:
    """The names of its bases, without the module; empty for one that is no name."""
    return [b.attr if isinstance(b, ast.Attribute) else getattr(b, "id", "") for b in node.bases]


def says_nothing(statement: ast.stmt) -> bool:
    """True for ``pass``, ``...`` and a docstring."""
    return isinstance(statement, ast.Pass) or (
        isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
    )
