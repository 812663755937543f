"""The titles that sections of a skill file have, in the spellings that people and models use."""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from enum import StrEnum

_RULES = r"(?:contracts?|rules?|specs?|specifications?|constraints?|requirements?|formula[es]?)"
_FORMAL = r"(?:(?:ltl|logical|formal|safety|temporal(?:[ -]logic)?)\s+)?"


class Kind(StrEnum):
    """A kind of section; the value is its canonical title."""

    SKILL = "Skill"
    GLOBAL = "Global Contract"
    LOCAL = "Local Contract"
    ASSUMPTIONS = "Environment Assumptions"
    SEMANTIC = "Semantic Contract"
    LABELLING = "Proposition-aligned APIs"
    APIS = "APIs"
    TEMPLATE = "Plan Template"

    @property
    def level(self) -> int:
        """The heading level in canonical writing."""
        if self is Kind.SKILL:
            return 1
        return 3 if self in (Kind.LABELLING, Kind.APIS, Kind.TEMPLATE) else 2

    @property
    def heading(self) -> str:
        """The canonical heading line."""
        return f"{'#' * self.level} {self.value}"


RULE_KINDS = (Kind.GLOBAL, Kind.LOCAL, Kind.ASSUMPTIONS)
TEXT_LEVEL = 2
"""Heading level of sections that VASO does not know."""

_PATTERNS: dict[Kind, str] = {
    Kind.SKILL: r"skill(?:\s+name)?(?:\s+\d+)?",
    Kind.GLOBAL: rf"(?:(?:shared|common)\s+)?(?:global|safety|platform)\s+{_FORMAL}{_RULES}"
    rf"|{_FORMAL}(?:specs?|specifications?)",
    Kind.LOCAL: rf"(?:local|(?:skill|task)[ -]specific)\s+{_FORMAL}{_RULES}",
    Kind.ASSUMPTIONS: r"(?:environment(?:al)?\s+)?assumptions?"
    r"(?:\s+(?:on|about)\s+(?:the\s+)?environment)?",
    Kind.SEMANTIC: r"semantic\s+contracts?",
    Kind.LABELLING: r"proposition[ -]+align(?:ed|ments?)"
    r"(?:\s+(?:python\s+)?(?:apis?|functions?|mappings?|code))?"
    r"|label+ing\s+(?:code|functions?)|(?:reusable\s+)?helper(?:s|\s+(?:layer|functions?|code))",
    Kind.APIS: r"(?:python\s+)?apis?",
    Kind.TEMPLATE: r"(?:python\s+)?plan(?:ning)?\s+templates?|python\s+plan|template",
}
_NUMBER = r"(?:\(?\d+(?:\.\d+)*[.)]?\s+)?"
_TITLES = {
    kind: re.compile(
        rf"{_NUMBER}(?:{pattern})\s*(?:[:：]\s*(?P<rest>.*)|(?P<more>[(\[].*|[-–—]\s+.*)?)",
        re.IGNORECASE | re.DOTALL,
    )
    for kind, pattern in _PATTERNS.items()
}
_DASH = re.compile(r"[-–—]\s+")


@dataclass(frozen=True, slots=True)
class Title:
    """A recognised title.

    Attributes:
        kind: The section's kind.
        rest: What follows the title on the line; for a skill, its name.
        colon: True when a colon stands between them.
    """

    kind: Kind
    rest: str
    colon: bool


def read_title(text: str) -> Title | None:
    """Recognise the title of a section at the start of a heading's text.

    Args:
        text: The text of a heading or label, without its Markdown signs.
    """
    if len(text) > 10_000:
        return None
    for kind, pattern in _TITLES.items():
        if match := pattern.fullmatch(text.strip()):
            colon = match["rest"] is not None
            if kind is Kind.SKILL and not (colon or match["more"] or "name" in text.lower()):
                return None
            return Title(
                kind, (match["rest"] or _undashed(kind, match["more"] or "")).strip(), colon
            )
    return None


def _undashed(kind: Kind, more: str) -> str:
    dash = _DASH.match(more)
    return more[dash.end() :] if dash and kind is Kind.SKILL else more


def near_miss(text: str) -> Kind | None:
    """The section that a heading which is none was probably meant to open."""
    title = re.sub(r"^[\d.()\s]+|[\s:*_`]+$", "", text).lower()
    if not 5 <= len(title) <= 40:
        return None
    names = {k.value.lower(): k for k in Kind if k not in (Kind.SKILL, Kind.APIS)}
    found = difflib.get_close_matches(title, names, n=1, cutoff=0.88)
    return names[found[0]] if found else None


def slug(text: str) -> str:
    """A skill's name as the Agent Skills convention wants it: lower case, digits and hyphens."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:64].strip("-")
