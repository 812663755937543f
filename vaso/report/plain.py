"""A view of the terminal as plain text: what ``print`` shows of a result."""

from __future__ import annotations

import io

from rich.console import Console, RenderableType

__all__ = ["plain"]


def plain(view: RenderableType) -> str:
    """A view in 80 columns without colour, and without blanks at the ends of lines."""
    file = io.StringIO()
    Console(file=file, width=80, color_system=None, highlight=False).print(view)
    return "\n".join(line.rstrip() for line in file.getvalue().rstrip().split("\n"))
