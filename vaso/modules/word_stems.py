"""Words by their stems, and words of the language of motion that mean much the same."""

from __future__ import annotations

import re
from collections.abc import Iterator

WORD = re.compile(r"[a-z]+")
ENDINGS = ("ing", "ed", "es", "s", "e")
IGNORED = frozenset(
    {
        "a", "an", "and", "at", "by", "for", "from", "in", "into", "it", "its", "of", "on", "or",
        "the", "them", "to", "until", "use", "while", "with", "your"
    }
)  # fmt: skip
ALIKE = {
    "around": "avoid", "past": "avoid", "bypass": "avoid", "dodge": "avoid",
    "reroute": "avoid", "found": "find", "detection": "find", "observe": "find", "see": "find",
    "look": "find", "search": "find", "locate": "find", "detect": "find", "spot": "find",
    "go": "move", "travel": "move", "drive": "move", "come": "move", "head": "move",
    "continue": "move", "navigate": "move", "advance": "move",
    "rotate": "turn", "left": "turn", "right": "turn", "degree": "angle",
    "meter": "distance", "metre": "distance", "m": "distance",
}  # fmt: skip
"""Words of the language of motion that mean much the same."""


def stems(text: str) -> frozenset[str]:
    """The stems of a text's words, without small words, words that mean the same as one."""
    return frozenset(_stems(text))


def _stems(text: str) -> Iterator[str]:
    for word in WORD.findall(text.lower()):
        if word not in IGNORED:
            stem = _stem(word)
            yield _STEMS.get(stem, stem)


def _stem(word: str) -> str:
    for ending in ENDINGS:
        if word.endswith(ending) and len(word) - len(ending) >= 3 and not word.endswith("ss"):
            return word.removesuffix(ending)
    return word


_STEMS = {_stem(word): _stem(same) for word, same in ALIKE.items()}
