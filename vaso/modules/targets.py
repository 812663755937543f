"""The object that a prompt wants found."""

from __future__ import annotations

import re

_ONE = r"(?:an?|the|any|some|my|your|our|his|her|this|that|one|a\s+single)"
_NEAREST = r"(?:(?:nearest|closest|first|next|nearby|missing|lost|other)\s+)*"
_SEEK = (
    r"(?:(?:search|look|hunt)(?:ing|es)?\b[\w\s]{0,60}?\bfor|"
    r"seek(?:ing)?(?:\s+out)?|find(?:ing)?|locat(?:e|ing)"
    r"|detect(?:ing)?|spot(?:ting)?|identify(?:ing)?|(?:until|when|once)\s+(?:(?:you|it|the\s+robot)"
    r"\s+)?(?:sees?|finds?|spots?|detects?|reach(?:es)?|notices?|encounters?|comes?\s+across)"
    r"|until)"
)
_END = (
    r"(?=\s+(?:and|or|near|next|by|is|are|was|while|when|where|in|on|at|until|that|which|then|once|"
    r"positioned|located|appears?|comes|without|inside|behind|within|with|to|from|under|beside|"
    r"around|along|across|through|before|after|if)\b|\s*[.,;:!?]|\s*$)"
)
_NAMED = re.compile(
    rf"\b{_SEEK}\s+(?:{_ONE}\s+)?{_NEAREST}(?P<noun>[a-z][a-z -]*?){_END}", re.IGNORECASE
)
_DETERMINED = re.compile(
    rf"\b{_SEEK}\s+{_ONE}\s+{_NEAREST}(?P<noun>[a-z][a-z -]*?){_END}", re.IGNORECASE
)
_NO_OBJECT = re.compile(r"^(?:out|a\s+way|way|it|them|everything|something|anything|you|further)\b")
_PLURAL = re.compile(r"(?:(?P<es>(?:x|ch|sh|ss))es|(?P<s>[^su])s)$")


def find_target(prompt: str) -> str | None:
    """The name of the object to look for, by its name for a detector; None if there is none.

    "Find a trash bin near the door" is a ``trash bin``; "look for chairs" is a ``chair``.
    """
    match = _DETERMINED.search(prompt)
    if match:
        return _plain(match["noun"])
    match = _NAMED.search(prompt)
    if match is None or _NO_OBJECT.search(match["noun"].lower()):
        return None
    if match[0].lower().startswith("until"):
        return None  # "until further notice", "until stopped": no object without an article
    return _singular(_plain(match["noun"]))


def target_span(prompt: str) -> tuple[int, int] | None:
    """Where a prompt names the object."""
    match = _DETERMINED.search(prompt) or _NAMED.search(prompt)
    return match.span() if match and find_target(prompt) else None


def _plain(noun: str) -> str:
    return " ".join(noun.lower().split())


def _singular(noun: str) -> str:
    match = _PLURAL.search(noun)
    if match is None:
        return noun
    return noun[: match.start()] + (match["es"] or match["s"])
