"""Read the quantities of a task prompt: distances, turns, heights, speeds, pauses, the target.

A small extractor without a language model. It scans the prompt once for the phrases of
:mod:`vaso.modules.phrases` and puts them together: a distance and the turn after it are one leg.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from vaso.modules.phrases import ANGLE, MORE, NUMBER, PLAIN_NUMBER, UNITS, WORDS, Phrase, scan
from vaso.modules.targets import find_target

METRES = {"cm": 0.01, "centi": 0.01, "km": 1000.0, "kilo": 1000.0, "f": 0.3048}
RIGHT_ANGLE = 90.0
MARGIN = 0.9
"""What to fly of a greatest speed: who holds a position in wind is faster than planned at times."""
SECONDS_PER_HOUR = 3600.0
STROKES = 2
"""How often a zig-zag route of alternating turns goes to and fro, where a prompt does not say."""
MOST_LEGS = 1000

CORNERS = {"triang": 3, "square": 4, "pentag": 5, "hexag": 6, "octag": 8}
SHAPE = re.compile(r"\b(triang|square|pentag|hexag|octag)\w*", re.IGNORECASE)
OBLONG = re.compile(r"\brectang\w*", re.IGNORECASE)
L_SHAPE = re.compile(r"\bL[\s-]?shap\w*|\bthe shape of an L\b", re.IGNORECASE)
ZIG_ZAG = re.compile(r"\bzig-?\s?zag\w*", re.IGNORECASE)
TIMES = re.compile(
    rf"\b(?P<twice>twice)\b|\b(?P<number>\d+|{'|'.join(WORDS)})\s+times\b", re.IGNORECASE
)
COUNTER = re.compile(r"\b(?:counter|anti)-?\s?clockwise\b", re.IGNORECASE)
CLOCKWISE = re.compile(r"\bclockwise\b", re.IGNORECASE)
RIGHT = re.compile(r"\bright\b", re.IGNORECASE)
LEVEL = re.compile(r"\bat\s+$", re.IGNORECASE)
FLIGHT = re.compile(r"\b(?:fl(?:y|ies|ying|ight)|hover\w*|drone|quad\w*copter)\b", re.IGNORECASE)

MOVES = ("distance", "turn", "alternating", "around", "place")


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
        speed_mps: Speed to travel at, in metres per second; 0.9 of the bound where a prompt
            gives the greatest speed ("below", "at most", "maximum").
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


def read_quantities(prompt: str, places: Mapping[str, float] | None = None) -> Quantities:
    """Read the quantities of a prompt.

    Args:
        prompt: A task in plain English, such as "move forward 5 meters, then turn left".
        places: Metres ahead of the robot to places that it may be sent to, by name: with
            ``{"doorway": 4.0}``, "go to the doorway" is a distance of 4 m.

    Returns:
        Its quantities, in SI units and degrees.
    """
    places = {name.lower(): metres for name, metres in (places or {}).items()}
    found: dict[str, float] = {}
    moves: list[Leg] = []
    for phrase in phrases_of(prompt, places):
        if phrase.kind == "backward":
            continue
        if phrase.kind in MOVES:
            moves += _moves(phrase, places)
        else:
            name, value = _quantity(phrase)
            found.setdefault(name, value)
    moves = _shaped(prompt, moves, found)
    return Quantities(
        distance_m=next((m.distance_m for m in moves if m.distance_m), None),
        turn_deg=next((m.turn_deg for m in moves if m.turn_deg), None),
        legs=tuple(_repeated(prompt, tuple(_legs(moves)))),
        clockwise=_sense(prompt),
        target=find_target(prompt),
        **found,
    )


def phrases_of(prompt: str, places: Mapping[str, float] | None = None) -> Iterator[Phrase]:
    """The phrases that carry a quantity, each with what it means in this prompt.

    "At 5 meters" is a height where the prompt is about a flight. The way to a place counts only
    where the prompt does not say itself how far to go.
    """
    found = list(scan(prompt, places or {}))
    told = any(p.kind == "distance" for p in found)
    is_flight = FLIGHT.search(prompt) is not None
    for phrase in found:
        if phrase.kind == "place" and told:
            continue
        if phrase.kind == "distance" and is_flight and LEVEL.search(prompt[: phrase.start]):
            phrase = phrase._replace(kind="height")
        yield phrase


def _moves(phrase: Phrase, places: Mapping[str, float]) -> list[Leg]:
    match phrase.kind:
        case "distance":
            return [Leg(distance_m=metres_in(phrase.text))]
        case "place":
            return [Leg(distance_m=places[" ".join(phrase.place.split())])]
        case "around":
            return [Leg(turn_deg=2 * RIGHT_ANGLE)]
    angle = _angle(phrase.text)
    alternating = phrase.kind == "alternating"
    return [Leg(turn_deg=angle), Leg(turn_deg=-angle)] if alternating else [Leg(turn_deg=angle)]


def _quantity(phrase: Phrase) -> tuple[str, float]:
    if phrase.kind in ("speed", "speed_below"):
        speed = _speed(phrase.text)
        below = phrase.kind == "speed_below"
        return "speed_mps", round(speed * MARGIN, 3) if below else speed
    if phrase.kind == "pause":
        return "pause_s", _number(phrase.text)
    names = {"height": "altitude_m", "side": "side_m", "sides": "side_m", "standoff": "standoff_m"}
    return names[phrase.kind], metres_in(phrase.text)


def _shaped(prompt: str, moves: list[Leg], found: dict[str, float]) -> list[Leg]:
    """Give moves the shape that a prompt names: a square, an L, a zig-zag."""
    turned = any(m.turn_deg for m in moves)
    distances = [m.distance_m for m in moves if m.distance_m]
    if (shape := SHAPE.search(prompt)) and not turned:
        if "side_m" not in found and len(distances) == 1:
            found["side_m"] = distances[0]
        if "side_m" in found:
            return _polygon(CORNERS[shape[1].lower()], found["side_m"], _sense(prompt))
    if OBLONG.search(prompt) and not turned and len(sides := _sides(prompt, distances)) == 2:
        found.pop("side_m", None)
        turn = Leg(turn_deg=_corner(90.0, _sense(prompt)))
        return [Leg(sides[0]), turn, Leg(sides[1]), turn] * 2
    if L_SHAPE.search(prompt) and not turned and len(distances) == 2:
        turn = Leg(turn_deg=_corner(90.0, bool(RIGHT.search(prompt))))
        return [Leg(distances[0]), turn, Leg(distances[1])]
    if ZIG_ZAG.search(prompt) and len(legs := list(_legs(moves))) == 2 and moves[-1].distance_m:
        return [part for leg in legs for part in (Leg(leg.distance_m), Leg(0.0, leg.turn_deg))] * (
            STROKES
        )
    return moves


def _sides(prompt: str, distances: Sequence[float]) -> list[float]:
    """The two sides of a rectangle: "3 m by 2 m", or two distances."""
    for phrase in scan(prompt):
        if phrase.kind == "sides":
            first, second = re.findall(PLAIN_NUMBER, phrase.text)[:2]
            scale = metres_in(phrase.text) / _value(second) if _value(second) else 1.0
            return [round(_value(side) * scale, 6) for side in (first, second)]
    return list(distances)


def _legs(moves: Sequence[Leg]) -> Iterator[Leg]:
    """Join each distance with the turn after it; alternating turns each get the distance."""
    turns = [m for m in moves if m.turn_deg]
    if len(moves) == 3 and len(turns) == 2 and not moves[1].distance_m:
        distance = moves[0].distance_m + moves[2].distance_m
        yield from (Leg(distance, turn.turn_deg) for turn in turns)
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


def _repeated(prompt: str, legs: tuple[Leg, ...]) -> tuple[Leg, ...]:
    """The legs as often as a prompt says: "twice", "four times"."""
    match = TIMES.search(prompt)
    if match is None:
        return legs
    times = 2 if match["twice"] else int(_value(match["number"].lower()))
    return legs * times if 0 < times * len(legs) <= MOST_LEGS else legs


def _polygon(corners: int, side: float, clockwise: bool | None) -> list[Leg]:
    return [Leg(distance_m=side), Leg(turn_deg=_corner(360.0 / corners, clockwise))] * corners


def _corner(degrees: float, clockwise: bool | None) -> float:
    return -degrees if clockwise else degrees


def _number(phrase: str) -> float:
    match = re.search(NUMBER, phrase)
    assert match is not None
    return _value(match.group(0))


def _value(text: str) -> float:
    words = " ".join(text.lower().split())
    if words.startswith("half"):
        return 0.5
    whole = words.removesuffix(" and a half")
    return (WORDS[whole] if whole in WORDS else float(whole)) + 0.5 * (whole != words)


def metres_in(phrase: str) -> float:
    """The length in a phrase that has one, in metres."""
    match = re.search(rf"(?P<number>{PLAIN_NUMBER}){MORE}[\s-]*(?P<unit>{UNITS})\b", phrase)
    assert match is not None
    return round(_value(match["number"]) * _scale(match["unit"]), 6)


def _scale(unit: str) -> float:
    """Metres in one of a unit of length."""
    return next((s for prefix, s in METRES.items() if unit.startswith(prefix)), 1.0)


def _speed(phrase: str) -> float:
    match = re.search(rf"(?P<number>{NUMBER})\s*(?P<unit>[a-z/\s]+)", phrase)
    assert match is not None
    unit = re.sub(r"\s+|per", "", match["unit"])
    length = next((s for prefix, s in METRES.items() if unit.startswith(prefix)), 1.0)
    length = METRES["km"] if unit.startswith("kp") else length
    hourly = unit.endswith(("h", "hr", "hour", "hours"))
    return round(_value(match["number"]) * length / (SECONDS_PER_HOUR if hourly else 1.0), 6)


def _angle(phrase: str) -> float:
    size = _number(phrase) if re.search(ANGLE, phrase) else RIGHT_ANGLE
    side = re.search(r"left|right|(?:counter|anti)-?\s?clockwise|clockwise", phrase)
    return -size if side and side.group(0) in ("right", "clockwise") else size


def _sense(prompt: str) -> bool | None:
    if COUNTER.search(prompt):
        return False
    return True if CLOCKWISE.search(prompt) else None
