"""Colours of pictures and animations; see :mod:`vaso.report.palette`."""

from __future__ import annotations

from vaso.report.palette import LIGHT

__all__ = ["ACTIVITY", "INK", "PEOPLE", "SEEN", "SOFT", "SOLID"]

INK, SOFT = LIGHT["ink"], LIGHT["soft"]
PEOPLE = "#d95f02"
SOLID = {
    "wall": INK,
    "furniture": "#d8c9b0",
    "edge": "#8a7656",
    "object": "#9d738f",
    "view": LIGHT["accent"],
}
SEEN = {"person": PEOPLE, "obstacle": "#713d05"}

ACTIVITY = {
    "drives": "#2155c0",
    "backs up": "#6d78dd",
    "turns left": "#1da460",
    "turns right": "#0f7d8c",
    "stands": "#e6b94f",
    "touches": "#b81f28",
    "climbs": "#1da460",
    "flies": "#2155c0",
    "hovers": "#e6b94f",
    "descends": "#9d738f",
    "lands": "#b81f28",
    "on the ground": "#b9c0ca",
}
