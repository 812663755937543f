"""How large the text of a formula may be."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["GENERATED", "UNLIMITED", "WRITTEN", "Limits"]


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds beyond which a text is refused.

    Attributes:
        length: Characters.
        brackets: Brackets inside one another.
        depth: Operators inside one another.
    """

    length: int
    brackets: int
    depth: int


WRITTEN = Limits(length=65_536, brackets=500, depth=500)
"""For rules that a person or a language model wrote."""

GENERATED = Limits(length=16_000_000, brackets=500_000, depth=500_000)
"""For formulas that a program wrote, such as those of benchmark collections."""

UNLIMITED = Limits(length=1 << 62, brackets=1 << 62, depth=1 << 62)
"""For texts that were formulas before."""
