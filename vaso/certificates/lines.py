"""Where a certificate stands in a skill file: lines of its own in ``metadata``, one an entry."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple

import yaml

from vaso.errors import SkillError
from vaso.skill_file.front_matter import (
    CERTIFICATE,
    MAX_CHARACTERS,
    certificate_line,
)

__all__ = ["Split", "insert", "prepare", "split"]

_ENTRY = re.compile(rf"""(?P<indent>[ \t]+)["']?{CERTIFICATE}""")
_METADATA = re.compile(r"metadata:[ \t]*(#.*)?$")


class Split(NamedTuple):
    """A file in two.

    Attributes:
        text: The file without the lines of the certificate.
        certificate: Those lines.
    """

    text: str
    certificate: tuple[str, ...]


def split(text: str) -> Split:
    """Take the certificate out of the text of a skill file, with lines that continue an entry."""
    lines = text.split("\n")
    begin, end = _front(lines)
    kept, taken = lines[:begin], list[str]()
    depth: int | None = None
    for line in lines[begin:end]:
        entry = _ENTRY.match(line)
        if entry:
            depth = len(entry["indent"])
        elif depth is not None and line.strip() and _depth(line) <= depth:
            depth = None
        (kept if depth is None or not line.strip() else taken).append(line)
    return Split("\n".join(kept + lines[end:]), tuple(taken))


def insert(text: str, entries: Mapping[str, str]) -> str:
    """Put a certificate into a text that :func:`prepare` has made ready.

    Args:
        text: The file without a certificate.
        entries: The certificate.

    Raises:
        SkillError: The front matter gets too long.
    """
    lines = text.split("\n")
    place, indent = _place(lines)
    new = [certificate_line(key, value, indent) for key, value in entries.items()]
    whole = [*lines[:place], *new, *lines[place:]]
    begin, end = _front(whole)
    if sum(len(line) + 1 for line in whole[begin:end]) > MAX_CHARACTERS:
        raise SkillError(
            "the certificate makes the front matter too long",
            expected=f"at most {MAX_CHARACTERS:,} characters",
        )
    return "\n".join(whole)


def prepare(text: str) -> str:
    """Make room for a certificate: a front matter with ``metadata:`` on a line of its own."""
    lines = text.split("\n")
    begin, end = _front(lines)
    if begin == end:
        return f"---\nmetadata:\n---\n{text}"
    if any(_METADATA.match(line) for line in lines[begin:end]):
        return text
    first, last, entries = _metadata(lines[begin:end])
    block = [f"  {line}" for line in entries.splitlines()]
    return "\n".join([*lines[: begin + first], "metadata:", *block, *lines[begin + last :]])


def _metadata(front: list[str]) -> tuple[int, int, str]:
    """Lines of the front matter that hold ``metadata`` (none: its end), and what it holds."""
    text = "\n".join(front)
    whole = yaml.compose(text, yaml.SafeLoader)
    for key, value in whole.value if whole else ():
        if key.value == "metadata":
            last = value.end_mark.line + (value.end_mark.column > 0)
            held = yaml.safe_load(text)["metadata"] or {}
            told = yaml.safe_dump(held, sort_keys=False, allow_unicode=True) if held else ""
            return key.start_mark.line, last, told
    return len(front), len(front), ""


def _front(lines: list[str]) -> tuple[int, int]:
    """Where the entries of the front matter begin and end; twice the same where there is none."""
    start = next((i for i, line in enumerate(lines) if line.strip()), len(lines))
    if start == len(lines) or lines[start].rstrip() != "---":
        return 0, 0
    marks = (i for i in range(start + 1, len(lines)) if lines[i].rstrip() in ("---", "..."))
    end = next(marks, None)
    return (0, 0) if end is None else (start + 1, end)


def _place(lines: list[str]) -> tuple[int, str]:
    """Where entries of ``metadata`` can be added, and how far they are indented."""
    begin, end = _front(lines)
    head = next(i for i in range(begin, end) if _METADATA.match(lines[i]))
    place, indent = head + 1, "  "
    for number in range(head + 1, end):
        line = lines[number]
        if line.strip() and not line[0].isspace():
            break
        if line.strip():
            indent = indent if place > head + 1 else line[: _depth(line)]
            place = number + 1
    return place, indent


def _depth(line: str) -> int:
    return len(line) - len(line.lstrip())
