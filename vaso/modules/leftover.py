"""What a planner without a language model could not use of a prompt.

A prompt's words are used if a phrase with a quantity covers them and the template has a place for
it; they are understood if they name what the skill does anyway (words of its name, description and
template) or carry no meaning of their own. Everything else is said to the user.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

from vaso.modules.phrases import Phrase
from vaso.modules.quantities import (
    CLOCKWISE,
    COUNTER,
    L_SHAPE,
    OBLONG,
    SHAPE,
    TIMES,
    ZIG_ZAG,
    metres_in,
    phrases_of,
)
from vaso.modules.targets import target_span
from vaso.modules.word_stems import stems
from vaso.skill import Skill

Span: TypeAlias = tuple[int, int]

BREAK = re.compile(r"[,;:!?]|\.(?!\d)")
WORD = re.compile(r"\d+(?:\.\d+)?|[^\W_]+(?:['’-][^\W_]+)*", re.UNICODE)
JOINING = frozenset(
    re.findall(
        r"\w+",
        "a an and any around as at by down each every for from in into is it its itself of on onto "
        "or our over so some that the their then there this through to toward towards up via when "
        "where while with within your you be are was all both either one once if",
    )
)
"""Words that say nothing alone."""
PLAIN = stems(
    "move go travel drive navigate head proceed advance continue keep carry come get follow take "
    "make perform execute complete generate trace traverse run do start begin starting finish end "
    "stop halt please now next again further more another finally after afterwards before robot "
    "vehicle straight ahead forward onward along path route course way trajectory pattern shape "
    "line direction distance metre m degree second left right side corner position point turn "
    "rotate safely safe carefully slowly smoothly necessary needed possible detected appears "
    "maintain use using limit motion speed velocity maximum minimum most least about approximately "
    "remain hold gently directly exactly nearly alternate total leg and moving whenever clear "
    "until reach arrive steady constant environment surroundings "
    "immediately instantly explore loop round ground whose long first third place"
)
"""Words of motion that every template answers by itself."""
OBSTACLES = stems(
    "obstacle object thing furniture furnishing chair stool table desk sofa couch bench bed shelf "
    "cabinet box crate carton block obstruct avoid anything everything"
)
"""Words for what a detector of obstacles reports."""
CONSTANTS = {
    "distance": ("legs", "distance_m"),
    "place": ("legs", "distance_m"),
    "turn": ("legs", "turn_deg"),
    "around": ("legs", "turn_deg"),
    "alternating": ("legs",),
    "speed": ("speed_mps",),
    "speed_below": ("speed_mps",),
    "height": ("altitude_m",),
    "side": ("side_m", "legs"),
    "sides": ("side_m", "legs"),
    "standoff": ("standoff_m",),
    "pause": ("pause_s",),
    "backward": (),
}
"""The constants of a template that can take each kind of phrase."""


def left_out(
    prompt: str,
    skill: Skill,
    used: Mapping[str, Any],
    places: Mapping[str, float] | None = None,
) -> tuple[str, ...]:
    """The parts of a prompt that did not go into a plan, as they stand in it.

    Args:
        prompt: The task.
        skill: The skill.
        used: The constants that were filled in.
        places: The places that were known.
    """
    covered, unplaced = _covered(prompt, used, places)
    known = stems(f"{skill.name} {skill.description} {skill.plan_template}") | PLAIN
    known |= OBSTACLES if "obstacle" in skill.labelling_code else frozenset()
    turns = {"left", "right"} if re.search(r"\blegs\b", skill.plan_template) else set()

    def is_plain(word: str) -> bool:
        return word.lower() not in turns and _is_plain(word, known)

    words = list(WORD.finditer(prompt))
    strange = [
        _inside(word.span(), unplaced)
        or not (_inside(word.span(), covered) or is_plain(word.group(0)))
        for word in words
    ]
    return tuple(_chunks(prompt, words, strange))


def _covered(
    prompt: str, used: Mapping[str, Any], places: Mapping[str, float] | None
) -> tuple[list[Span], list[Span]]:
    """Where the words are that went into the plan, and the phrases that it has no place for."""
    covered: list[Span] = []
    unplaced: list[Span] = []
    for phrase in phrases_of(prompt, places):
        (covered if _is_used(phrase, used) else unplaced).append((phrase.start, phrase.end))
    if "TARGET" in used and (span := target_span(prompt)):
        covered.append(span)
    shapes = [SHAPE, OBLONG, L_SHAPE, ZIG_ZAG, TIMES] if "legs" in used else []
    shapes += [CLOCKWISE, COUNTER] if {"clockwise", "legs"} & set(used) else []
    return covered + [m.span() for shape in shapes for m in shape.finditer(prompt)], unplaced


def _is_used(phrase: Phrase, used: Mapping[str, Any]) -> bool:
    if phrase.kind == "distance" and "legs" not in used:  # a single constant takes one distance
        return metres_in(phrase.text) in (used.get("distance_m"), used.get("side_m"))
    return any(name in used for name in CONSTANTS[phrase.kind])


def _is_plain(word: str, known: frozenset[str]) -> bool:
    parts = word.lower().split("-")
    return all(part in JOINING or frozenset() < stems(part) <= known for part in parts)


def _inside(span: Span, covered: Sequence[Span]) -> bool:
    return any(start <= span[0] and span[1] <= end for start, end in covered)


def _chunks(prompt: str, words: Sequence[re.Match[str]], strange: Sequence[bool]) -> list[str]:
    """Strange words that follow each other, with the small words before and between them."""
    chunks: list[Span] = []
    lead: int | None = None  # where the small words right before this word begin
    is_open = False  # whether only small words have come since the last chunk
    behind = 0
    for word, is_strange in zip(words, strange, strict=True):
        if BREAK.search(prompt[behind : word.start()]):
            lead, is_open = None, False
        behind = word.end()
        if is_strange:
            start = chunks.pop()[0] if is_open else word.start() if lead is None else lead
            chunks.append((start, word.end()))
            lead, is_open = None, True
        elif word.group(0).lower() in JOINING:
            lead = word.start() if lead is None else lead
        else:
            lead, is_open = None, False
    return [prompt[start:end] for start, end in chunks]
