"""Text of others on its way to a terminal, which must not act on it.

Plans, formulas and skills are written by others. An escape sequence in them could clear the screen
and print a verdict of its own.
"""

from __future__ import annotations

from collections.abc import Iterable

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

_PICTURES = {n: chr(0x2400 + n) for n in range(32) if chr(n) not in "\n\t"}
_SHOWN = {**_PICTURES, 127: "\u2421", **{n: "\ufffd" for n in range(128, 160)}}


def plain(text: str) -> str:
    """A text with its control characters made visible; line ends and tabs stay."""
    return text.translate(_SHOWN)


class PlainConsole(Console):
    """A console that prints control characters of texts as something that can be seen."""

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Render, as in the base class."""
        for segment in super().render(renderable, options):
            unseen = segment.control or segment.text.isprintable()
            yield segment if unseen else Segment(plain(segment.text), segment.style)
