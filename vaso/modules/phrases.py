"""The phrases of a task prompt that carry a quantity, found by one pattern per kind of phrase.

The most specific pattern comes first, so that "5 meters altitude" is a height and not a distance.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from typing import NamedTuple

_SMALL = (
    "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen "
    "sixteen seventeen eighteen nineteen twenty"
)
WORDS = {word: float(value) for value, word in enumerate(_SMALL.split())}
WORDS |= {"thirty": 30.0, "forty": 40.0, "forty-five": 45.0, "sixty": 60.0, "ninety": 90.0}
"""Numbers in words."""

_NAMED = "|".join(sorted(WORDS, key=len, reverse=True))
PLAIN_NUMBER = rf"(?:\d+(?:\.\d+)?|\.\d+|(?:{_NAMED})(?:\s+and\s+a\s+half)?|half\s+an?)"
NUMBER = rf"(?<![\w.])(?<!\d,)(?<!\s[-−]){PLAIN_NUMBER}"
"""A number that is neither negative nor what follows a decimal comma: these are not understood."""
UNITS = r"(?:met(?:er|re)s?|m|centimet(?:er|re)s?|cm|kilomet(?:er|re)s?|km|feet|foot|ft)"
MORE = r"(?:\s+(?:more|further|additional))?"
LENGTH = rf"{NUMBER}{MORE}[\s-]*{UNITS}\b(?!\s*(?:/|per\s+(?:s|sec|second|h|hr|hour)\b))"
SPEED = rf"{NUMBER}\s*(?:mps|kph|{UNITS}\s*(?:/|per)\s*(?:seconds?|sec|s|hours?|hr|h))\b"
ANGLE = rf"{NUMBER}[\s-]*(?:degrees?|deg\b|°)"
SECONDS = rf"{NUMBER}[\s-]*(?:seconds?|secs?|s)\b"
SIDE = r"(?:to\s+(?:the|your)\s+)?(?:left|right|anti-?clockwise|counter-?\s?clockwise|clockwise)\b"
TURN = r"\b(?:turn|rotat|pivot|spin|yaw)(?:e|s|es|ed|ing)?\b(?:\s+(?:in\s+place|on\s+the\s+spot))?"
PAUSE = r"\b(?:paus|wait|hover|hold|rest|stay)\w*"
BELOW = (
    r"\b(?:below|under|(?:less|slower)\s+than|at\s+most|up\s+to|no(?:t)?\s+(?:more|faster)\s+than"
    r"|(?:not|never|without)\s+(?:exceed|reach)\w*|(?:limit|cap|restrict)\w*(?:\s+\w+){0,3}?"
    r"\s+(?:to|at)|limit(?:\s+(?:of|is))*|max(?:imum|imal)?(?:\s+(?:speed|velocity|of|is|at))*)\s*[:=]?\s+"
)
IS = r"(?:\s*[:=]\s*|\s+(?:(?:up|of|at|to|is|are|being|measur\w+|with)\s+)*)"
ANGLED = rf"(?:\s*,?\s+(?:by\s+|through\s+|of\s+)?{ANGLE})"

PHRASES = {
    "speed_below": rf"{BELOW}{SPEED}",
    "speed": SPEED,
    "height": rf"\b(?:altitude|height|climb\w*|ascend\w*|take\s?off){IS}{LENGTH}"
    rf"|{LENGTH}\s+(?:of\s+)?(?:altitude|height|(?:high|up|above)\b)",
    "side": rf"\b(?:side|edge)s?(?:\s+lengths?)?{IS}{LENGTH}|\bwidth{IS}{LENGTH}"
    rf"|{LENGTH}(?:\s+|-)(?:(?:on|per|each|a|long|every)\s+)*(?:sides?|edges?|wide)\b"
    rf"|{LENGTH}(?:\s+|-)(?:squares?|triangles?|pentagons?|hexagons?|octagons?)\b",
    "sides": rf"{NUMBER}[\s-]*{UNITS}?\s*(?:x|×|by)\s*{PLAIN_NUMBER}[\s-]*{UNITS}\b",
    "standoff": rf"{LENGTH}\s+(?:away|from|in\s+front\s+of|short\s+of|before)\b",
    "pause": rf"{SECONDS}\s+(?:long\s+)?{PAUSE}|{PAUSE}\s+(?:\w+\s+){{0,5}}{SECONDS}",
    "alternating": rf"{ANGLE}\s+(?:turns?\s*,?\s+)?(?:left|right)\s+and\s+(?:left|right)\b"
    r"(?:\s+turns?)?",
    "around": rf"{TURN}\s+(?:around|back)\b(?!\s+(?:the|an?)\b)|\bu-turn\b"
    r"|\babout-?\s?(?:turn|face)\b",
    "turn": rf"{TURN}\s+{SIDE}{ANGLED}?|{ANGLE}\s+(?:turn\s+)?{SIDE}"
    r"|\b(?:then|and|go|head|take\s+a)\s+(?:left|right)\b"
    r"(?!\s+(?:and|or|side|sides|turns?|away|now|ahead|after)\b)"
    rf"|{TURN}{ANGLED}(?:\s+{SIDE})?|\b(?:left|right)(?:-hand)?\s+turn{ANGLED}?",
    "backward": rf"\b(?:backwards?|revers\w+|back\s+up)\s+(?:\w+\s+){{0,2}}{LENGTH}"
    rf"|{LENGTH}\s+(?:back(?:wards?)?|in\s+reverse)\b(?!\s+to\b)",
    "distance": LENGTH,
}
"""Regular expressions by kind of phrase, the most specific first."""

BEFORE_A_PLACE = (
    r"\b(?:to|reach\w*|towards?|until|till|up\s+to|as\s+far\s+as|into|through|enter\w*)\s+"
    r"(?:you\s+(?:are\s+at|reach)\s+)?(?:the\s+|an?\s+)?"
)


class Phrase(NamedTuple):
    """A phrase with a quantity.

    Attributes:
        kind: Which of :data:`PHRASES`; ``place`` for the way to a place.
        text: Its words, in lower case.
        start: Where it starts in the prompt.
        end: Where it ends.
        place: The name of the place, for the way to one.
    """

    kind: str
    text: str
    start: int
    end: int
    place: str = ""


def scan(prompt: str, places: Collection[str] = ()) -> Iterator[Phrase]:
    """Find the phrases of a prompt that carry a quantity, in their order.

    Args:
        prompt: A task in plain English.
        places: Names of places whose distance is known.
    """
    for match in _scanner(places).finditer(prompt):
        kind = next(k for k in (*PHRASES, "place") if match.groupdict().get(k) is not None)
        place = match.group("name").lower() if kind == "place" else ""
        yield Phrase(kind, match.group(0).lower(), match.start(), match.end(), place)


def _scanner(places: Collection[str]) -> re.Pattern[str]:
    kinds = dict(PHRASES)
    if places:
        longest_first = sorted(places, key=len, reverse=True)
        names = "|".join(r"\s+".join(map(re.escape, name.split())) for name in longest_first)
        kinds["place"] = rf"{BEFORE_A_PLACE}(?P<name>{names})\b"
    return re.compile("|".join(f"(?P<{kind}>{p})" for kind, p in kinds.items()), re.IGNORECASE)
