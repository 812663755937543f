"""What stands about in a scene: furniture and small objects."""

from __future__ import annotations

import math
from typing import Annotated, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from vaso.simulation.geometry import Point, rectangle

__all__ = ["Finite", "Furniture", "Item", "Length", "Metres", "NonNegative", "Part", "Position"]

NonNegative: TypeAlias = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Metres: TypeAlias = NonNegative
Length: TypeAlias = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Finite: TypeAlias = Annotated[float, Field(allow_inf_nan=False)]
Position: TypeAlias = tuple[Finite, Finite]

SIZES: dict[str, tuple[float, float]] = {
    "chair": (0.5, 0.5),
    "stool": (0.4, 0.4),
    "table": (1.2, 0.8),
    "desk": (1.4, 0.7),
    "sofa": (1.8, 0.85),
    "bench": (1.2, 0.4),
    "bed": (2.0, 1.4),
    "shelf": (1.0, 0.35),
    "cabinet": (0.9, 0.45),
    "box": (0.5, 0.4),
}
"""Usual footprints in metres; anything else is 0.6 m square."""

HEIGHTS: dict[str, float] = {
    "chair": 0.9,
    "stool": 0.5,
    "table": 0.75,
    "desk": 0.75,
    "sofa": 0.8,
    "bench": 0.45,
    "bed": 0.55,
    "shelf": 1.8,
    "cabinet": 1.8,
    "box": 0.5,
    "backpack": 0.45,
    "bottle": 0.25,
    "trash bin": 0.6,
}
"""Usual heights in metres; other furniture is 0.8 m high, other objects 0.3 m."""

OPEN = frozenset({"chair", "stool", "table", "desk", "bench"})
"""Furniture that one can see through, below or between its legs."""


class Part(BaseModel):
    """A part of a scene: immutable, and without fields that nobody knows."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Furniture(Part):
    """A piece of furniture.

    Attributes:
        kind: What a detector calls it: ``chair``, ``table``, ``box``.
        at: Its middle in metres.
        size: Length and width in metres; by default what is usual for its kind.
        heading: Degrees.
        height: Metres; by default what is usual for its kind.
        opaque: Whether it hides what is behind it and lower than itself; by default, not for
            chairs, tables and other open frames.
        spread: Each seed moves it by up to this many metres.
    """

    kind: str
    at: Position
    size: tuple[Length, Length] | None = None
    heading: Finite = 0.0
    height: Length | None = None
    opaque: bool | None = None
    spread: Metres = 0.0

    @property
    def polygon(self) -> tuple[Point, ...]:
        """Its footprint."""
        size = self.size or SIZES.get(self.kind, (0.6, 0.6))
        return rectangle(self.at, size, math.radians(self.heading))

    @property
    def top(self) -> float:
        """How high it reaches, in metres."""
        return self.height or HEIGHTS.get(self.kind, 0.8)

    @property
    def hides(self) -> bool:
        """Whether things behind it cannot be seen."""
        return self.opaque if self.opaque is not None else self.kind not in OPEN


class Item(Part):
    """A small object: backpack, bottle, trash bin.

    Attributes:
        kind: What a detector calls it.
        at: Position in metres.
        radius: Of its footprint in metres.
        elevation: Height of what it stands on; with 0 it stands on the floor and is in the way.
        height: Metres; by default what is usual for its kind.
        spread: Each seed moves it by up to this many metres.
    """

    kind: str
    at: Position
    radius: Length = 0.15
    elevation: Metres = 0.0
    height: Length | None = None
    spread: Metres = 0.0

    @property
    def top(self) -> float:
        """How high it reaches, in metres."""
        return self.elevation + (self.height or HEIGHTS.get(self.kind, 0.3))
