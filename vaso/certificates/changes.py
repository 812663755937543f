"""What differs between a certificate and a skill file, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from difflib import SequenceMatcher

from vaso.certificates.content import FORMAT, SEAL, content, sealed, stored_in
from vaso.certificates.lines import split
from vaso.certificates.result import Change
from vaso.skill import Skill
from vaso.skill_file.front_matter import CERTIFICATE, certificate_line

__all__ = ["content_changes", "verdict_changes"]

_EDITED = "the certificate itself was edited"
_PARTS = {
    "-labelling-code": ("labelling code", "the labelling code was edited"),
    "-plan-template": ("plan template", "the plan template was edited"),
}


def content_changes(skill: Skill, text: str) -> list[Change]:
    """What in a file is not what its certificate speaks of; nothing is verified.

    Args:
        skill: The skill that was read from the file.
        text: The text of the file, with the certificate.
    """
    rest, lines = split(text)
    stored, now = stored_in(skill), content(skill, rest)
    changes = [] if _is_whole(stored, lines) else [Change("certificate", _EDITED)]
    parts = [*_rules(stored, now), *_parts(stored, now)]
    if not parts and _differs(stored, now, "-text"):
        told = "the text around rules and code was edited (prose, headings or spacing)"
        parts.append(Change("text", told))
    return changes + parts


def verdict_changes(
    stored: Mapping[str, str], now: Mapping[str, str]
) -> tuple[list[Change], list[Change]]:
    """What verifies differently, and what differs in the engines alone.

    Args:
        stored: The certificate.
        now: The certificate that a new verification would give.
    """
    told = [*_on_rules(stored, now), *_on_all(stored, now)]
    found = [Change("verdict", text) for text in told]
    before, after = (entries.get(f"{CERTIFICATE}-engines", "") for entries in (stored, now))
    if before == after:
        return found, []
    same = "" if found else " (the verdicts are the same)"
    return found, [Change("engines", f"engine versions differ{same}: were {before}, are {after}")]


def _on_rules(stored: Mapping[str, str], now: Mapping[str, str]) -> Iterator[str]:
    """Verdicts on rules that are in both."""
    before = {entry: number for number, entry in _listed(stored, "rule").items()}
    for number, entry in _listed(now, "rule").items():
        for kind, words in (("verdict", "verdict"), ("between", "verdict between samples")):
            was = stored.get(f"{CERTIFICATE}-{kind}-{before.get(entry)}")
            found = now.get(f"{CERTIFICATE}-{kind}-{number}")
            if entry in before and was != found:
                yield f"{words} on rule {number}: was {was or 'none'}, is {found or 'none'}"


def _on_all(stored: Mapping[str, str], now: Mapping[str, str]) -> Iterator[str]:
    for name, words in (("verdict", "verdict"), ("labels", "label validation")):
        was, found = (entries.get(f"{CERTIFICATE}-{name}") for entries in (stored, now))
        if was != found:
            yield f"{words}: was {was or 'none'}, is {found or 'none'}"


def _is_whole(stored: Mapping[str, str], lines: Sequence[str]) -> bool:
    """True when a certificate is as it was written, to the character."""
    indent = lines[0][: len(lines[0]) - len(lines[0].lstrip())] if lines else ""
    written = [certificate_line(key, value, indent) for key, value in stored.items()]
    is_ours = stored.get(CERTIFICATE) == FORMAT and list(stored)[-1:] == [SEAL]
    return is_ours and written == list(lines) and stored.get(SEAL) == sealed(stored)


def _differs(stored: Mapping[str, str], now: Mapping[str, str], name: str) -> bool:
    return stored.get(CERTIFICATE + name) != now[CERTIFICATE + name]


def _parts(stored: Mapping[str, str], now: Mapping[str, str]) -> Iterator[Change]:
    for name, (what, told) in _PARTS.items():
        if _differs(stored, now, name):
            yield Change(what, told)
    if _differs(stored, now, "-platform"):
        before, after = (
            e.get(f"{CERTIFICATE}-platform", "").rpartition("; ")[0] for e in (stored, now)
        )
        same = f"the definition of platform {after} changed"
        yield Change(
            "platform", same if before == after else f"the platform was {before}, is {after}"
        )


def _rules(stored: Mapping[str, str], now: Mapping[str, str]) -> Iterator[Change]:
    for kind in ("rule", "assumption"):
        before, after = (list(_listed(entries, kind).values()) for entries in (stored, now))
        blocks = SequenceMatcher(None, before, after, autojunk=False).get_opcodes()
        for tag, a, b, c, d in blocks:
            if tag != "equal":
                for told in _replaced(kind, before[a:b], after[c:d], a + 1, c + 1):
                    yield Change(kind, told)


def _replaced(
    kind: str, before: Sequence[str], after: Sequence[str], first: int, now: int
) -> Iterator[str]:
    """Rules of a certificate, from number ``first`` on, that are other ones now."""
    pairs = min(len(before), len(after))
    for offset in range(pairs):
        yield f"{kind} {now + offset} was edited: {_edit(before[offset], after[offset])}"
    for number, entry in enumerate(before[pairs:], start=first + pairs):
        yield f"{kind} {number} was removed: {_formula(entry)}"
    for number, entry in enumerate(after[pairs:], start=now + pairs):
        yield f"{kind} {number} was added: {_formula(entry)}"


def _listed(entries: Mapping[str, str], kind: str) -> dict[str, str]:
    """The rules of a certificate by number."""
    head = f"{CERTIFICATE}-{kind}-"
    return {k.removeprefix(head): v for k, v in entries.items() if k.startswith(head)}


def _edit(before: str, after: str) -> str:
    was, now = _formula(before), _formula(after)
    if was != now:
        return f"was {was}, is {now}"
    roles = before.partition("; ")[0], after.partition("; ")[0]
    if roles[0] != roles[1]:
        return f"was a {roles[0]} rule, is a {roles[1]} one"
    return f"written differently, the same formula {now}"


def _formula(entry: str) -> str:
    return entry.split("; ", 2)[-1]
