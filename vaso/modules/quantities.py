"""Read the quantities of a task prompt: distances, turns, heights, speeds, pauses, the target.

A small extractor without a language model. It scans the prompt once with one pattern per kind of
phrase, the most specific first, so that "5 meters altitude" is a height and not a distance.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

WORDS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
METRES = {"cm": 0.01, "centi": 0.01, "km": 1000.0, "kilo": 1000.0, "f": 0.3048}
RIGHT_ANGLE = 90.0
STRICT_MARGIN = 0.9


@dataclass(frozen=True, slots=True)
class Leg:
    """Drive straight, then turn on the spot.

    Attributes:
        distance_m: Metres ahead.
        turn_deg: Degrees, positive to the left.
    """

    distance_m: float = 0.0
    turn_deg: float = 0.0


@dataclass(frozen=True)
class Quantities:
    """What a prompt says in numbers; None where it says nothing.

    Attributes:
        distance_m: First distance to travel, in metres.
        turn_deg: First turn, in degrees, positive to the left.
        legs: Every distance and turn in the order of the prompt.
        side_m: Side of a square, in metres.
        altitude_m: Height above the ground, in metres.
        speed_mps: Speed to travel at, in metres per second; 0.9 of the bound that a prompt wants
            the speed to stay *below*.
        pause_s: Length of a pause, in seconds.
        standoff_m: Distance to keep from the target ("stop 1 meter away"), in metres.
        clockwise: Sense of going round.
        target: The object to look for.
    """

    distance_m: float | None = None
    turn_deg: float | None = None
    legs: tuple[Leg, ...] = ()
    side_m: float | None = None
    altitude_m: float | None = None
    speed_mps: float | None = None
    pause_s: float | None = None
    standoff_m: float | None = None
    clockwise: bool | None = None
    target: str | None = None

    def constants(self) -> dict[str, Any]:
        """The values by the names that plan templates give their constants."""
        named = {k: v for k, v in vars(self).items() if v is not None}
        del named["legs"]
        if self.legs:
            named["legs"] = [(leg.distance_m, leg.turn_deg) for leg in self.legs]
        if "target" in named:
            named["TARGET"] = named.pop("target")
        return named


NUMBER = rf"(?<![\w.])(?:\d+(?:\.\d+)?|\.\d+|{'|'.join(WORDS)})"
LENGTH = (
    rf"{NUMBER}[\s-]*(?:met(?:er|re)s?|m|centimet(?:er|re)s?|cm|kilomet(?:er|re)s?|km|feet|foot|ft)"
)
LENGTH += r"\b(?!\s*(?:/|per\b))"
SPEED = rf"{NUMBER}\s*(?:m/s|mps|(?:meters?|metres?|m)\s*(?:/|per)\s*(?:s|seconds?))\b"
ANGLE = rf"{NUMBER}[\s-]*(?:degrees?|deg|°)"
SECONDS = rf"{NUMBER}[\s-]*(?:seconds?|secs?|s)\b"
SIDE = r"(?:to\s+(?:the|your)\s+)?(?:left|right|anti-?clockwise|counter-?\s?clockwise|clockwise)\b"
TURN = r"\b(?:turn|rotat|pivot|spin|yaw)(?:e|s|es|ed|ing)?\b"
PAUSE = r"\b(?:paus|wait|hover|hold|rest|stay)\w*"
BELOW = r"\b(?:below|under|less than)\s+"

PHRASES = {
    "speed_below": rf"{BELOW}{SPEED}",
    "speed": SPEED,
    "height": rf"\b(?:altitude|height|climb\w*|ascend\w*|take\s?off)\s+"
    rf"(?:(?:up|of|at|to)\s+)*{LENGTH}|{LENGTH}\s+(?:of\s+)?(?:altitude|height|(?:high|up|above)\b)",
    "side": rf"\b(?:side|edge)s?(?:\s+lengths?)?\s+(?:of\s+)?{LENGTH}|\bwidth\s+(?:of\s+)?{LENGTH}"
    rf"|{LENGTH}(?:\s+|-)(?:sides?|edges?|wide|squares?)\b|{LENGTH}\s*(?:x|×|by)\s*{LENGTH}",
    "standoff": rf"{LENGTH}\s+(?:away|from)\b",
    "pause": rf"{SECONDS}\s+(?:long\s+)?{PAUSE}|{PAUSE}\s+(?:\w+\s+){{0,3}}{SECONDS}",
    "alternating": rf"{ANGLE}\s+(?P<first>left|right)\s+and\s+(?:left|right)\s+turns?",
    "around": rf"{TURN}\s+(?:around|back)\b(?!\s+(?:the|an?)\b)|\bu-turn\b",
    "turn": rf"{TURN}\s+{SIDE}(?:\s+(?:by\s+|through\s+)?{ANGLE})?|{ANGLE}\s+{SIDE}"
    rf"|{TURN}\s+(?:by\s+|through\s+)?{ANGLE}(?:\s+{SIDE})?|\bleft\s+turn|\bright\s+turn",
    "distance": LENGTH,
}
SCANNER = re.compile("|".join(f"(?P<{kind}>{p})" for kind, p in PHRASES.items()), re.IGNORECASE)

_NOUN = r"(?:an?|the|any|some)\s+(?P<noun>[a-z][a-z -]*?)"
_END = (
    r"(?=\s+(?:and|or|near|next|by|is|are|was|while|when|where|in|on|at|until|that|which|then|once|"
    r"positioned|located|appears?|comes|without|inside|behind|within|with)\b|\s*[.,;:!?]|\s*$)"
)
TARGET = re.compile(
    rf"\b(?:(?:search|look|hunt)(?:ing)?\b[\w\s]*?\bfor|find|locate|detect|spot|until)\s+{_NOUN}{_END}",
    re.IGNORECASE,
)
COUNTER = re.compile(r"\b(?:counter|anti)-?\s?clockwise\b", re.IGNORECASE)
CLOCKWISE = re.compile(r"\bclockwise\b", re.IGNORECASE)
SQUARE = re.compile(r"\bsquare\b", re.IGNORECASE)


def read_quantities(prompt: str) -> Quantities:
    """Read the quantities of a prompt.

    Args:
        prompt: A task in plain English, such as "move forward 5 meters, then turn left".

    Returns:
        Its quantities, in SI units and degrees.
    """
    found: dict[str, float] = {}
    moves: list[Leg] = []
    for kind, phrase in _phrases(prompt):
        if kind in ("distance", "turn", "alternating", "around"):
            moves += _moves(kind, phrase)
        else:
            name, value = _quantity(kind, phrase)
            found.setdefault(name, value)
    if SQUARE.search(prompt) and not moves and "side_m" in found:
        moves = _square(found["side_m"], _sense(prompt))
    return Quantities(
        distance_m=next((m.distance_m for m in moves if m.distance_m), None),
        turn_deg=next((m.turn_deg for m in moves if m.turn_deg), None),
        legs=tuple(_legs(moves)),
        clockwise=_sense(prompt),
        target=_target(prompt),
        **found,
    )


def _phrases(prompt: str) -> Iterator[tuple[str, str]]:
    for match in SCANNER.finditer(prompt):
        kind = next(k for k in PHRASES if match.group(k) is not None)
        yield kind, match.group(0).lower()


def _moves(kind: str, phrase: str) -> list[Leg]:
    if kind == "distance":
        return [Leg(distance_m=_metres(phrase))]
    if kind == "around":
        return [Leg(turn_deg=2 * RIGHT_ANGLE)]
    angle = _angle(phrase)
    return [Leg(turn_deg=angle)] if kind == "turn" else [Leg(turn_deg=angle), Leg(turn_deg=-angle)]


def _quantity(kind: str, phrase: str) -> tuple[str, float]:
    if kind in ("speed", "speed_below"):
        speed = _number(phrase)
        return "speed_mps", round(speed * STRICT_MARGIN, 3) if kind == "speed_below" else speed
    if kind == "pause":
        return "pause_s", _number(phrase)
    return {"height": "altitude_m", "side": "side_m", "standoff": "standoff_m"}[kind], _metres(
        phrase
    )


def _legs(moves: list[Leg]) -> Iterator[Leg]:
    """Join each distance with the turn after it; alternating turns each get the distance."""
    turns = [m for m in moves if m.turn_deg]
    if len(moves) == 3 and len(turns) == 2 and moves[2].distance_m:
        yield from (Leg(moves[2].distance_m, t.turn_deg) for t in turns)
        return
    waiting: Leg | None = None
    for move in moves:
        if waiting and move.turn_deg:
            yield Leg(waiting.distance_m, move.turn_deg)
            waiting = None
        else:
            if waiting:
                yield waiting
            waiting = move if move.distance_m else None
            if not waiting:
                yield move
    if waiting:
        yield waiting


def _square(side: float, clockwise: bool | None) -> list[Leg]:
    turn = Leg(turn_deg=-RIGHT_ANGLE if clockwise else RIGHT_ANGLE)
    return [Leg(distance_m=side), turn] * 4


def _number(phrase: str) -> float:
    match = re.search(NUMBER, phrase)
    assert match is not None
    text = match.group(0)
    return float(WORDS.index(text)) if text in WORDS else float(text)


def _metres(phrase: str) -> float:
    unit = re.search(rf"{NUMBER}[\s-]*([a-z]+)", phrase)
    assert unit is not None
    scale = next((s for prefix, s in METRES.items() if unit.group(1).startswith(prefix)), 1.0)
    return round(_number(phrase) * scale, 6)


def _angle(phrase: str) -> float:
    size = _number(phrase) if re.search(ANGLE, phrase) else RIGHT_ANGLE
    side = re.search(r"left|right|(?:counter|anti)-?\s?clockwise|clockwise", phrase)
    return -size if side and side.group(0) in ("right", "clockwise") else size


def _sense(prompt: str) -> bool | None:
    if COUNTER.search(prompt):
        return False
    return True if CLOCKWISE.search(prompt) else None


def _target(prompt: str) -> str | None:
    match = TARGET.search(prompt)
    return match.group("noun").strip().lower() if match else None
