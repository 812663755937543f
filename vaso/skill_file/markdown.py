"""The few parts of Markdown that matter to a skill file: headings, labels and code fences.

Written for what people and language models really write: a section may open with ``## Title``,
``**Title:**`` or ``Title:``, and a list item may hold a fence.
"""

from __future__ import annotations

import re
import textwrap
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from vaso.errors import SkillError
from vaso.skill_file.titles import TEXT_LEVEL, Kind, Title, read_title

_ATX = re.compile(r"\s{0,3}(#{1,6})(?!#)(\s*)(.*)", re.DOTALL)
_BOLD = re.compile(r"\s*(?:(?:[-*+]|\d+[.)])\s+)?(\*\*|__)(?=\S)(.+?)(?<=\S)\1\s*:?\s*(.*)")
_NUMBERED = re.compile(r"\s*\(?\d+[.)]\s+")
_UNDERLINE = re.compile(r"\s{0,3}(=+|-+)\s*")
_FENCE = re.compile(r"(\s*(?:(?:[-*+]|\d+[.)])\s+)?)(`{3,}|~{3,})\s*([^`]*)")
_MARKS = re.compile(r"[*`]+|__+")

LABEL_LEVEL = 7
"""Rank of a bold or plain label: below every heading."""


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading or label that opens a section.

    Attributes:
        line: Its line in the file.
        level: 1 to 6, or LABEL_LEVEL.
        text: What it says.
        kind: The section that it opens, or None if VASO does not know it.
        name: For a skill heading: the skill's name as written.
    """

    line: int
    level: int
    text: str
    kind: Kind | None = None
    name: str = ""


@dataclass(frozen=True, slots=True)
class Text:
    """A line of text."""

    line: int
    text: str


@dataclass(frozen=True, slots=True)
class Fence:
    """A fenced block of code.

    Attributes:
        line: Line of the file on which its first line of code stands.
        language: First word of the info string, lower case.
        code: Its text without blank lines at both ends.
        raw: The whole block as written.
    """

    line: int
    language: str
    code: str
    raw: str

    @property
    def is_python(self) -> bool:
        """True for blocks that say Python, or nothing."""
        return self.language in ("", "python", "py", "python3", "code")


Block: TypeAlias = Heading | Text | Fence


def read_blocks(lines: list[str], first_line: int, source: str | None) -> list[Block]:
    """Split Markdown text into headings, lines and fences.

    Args:
        lines: The lines.
        first_line: Number of the first of them in the file.
        source: The file, for messages.

    Raises:
        SkillError: A fence is never closed.
    """
    pending = deque(enumerate(lines, first_line))
    return list(_blocks(pending, source))


def _blocks(pending: deque[tuple[int, str]], source: str | None) -> Iterator[Block]:
    while pending:
        number, line = pending.popleft()
        if fence := _FENCE.fullmatch(line):
            yield _fence(number, line, fence, pending, source)
            continue
        underlined = bool(pending and _UNDERLINE.fullmatch(pending[0][1]))
        found = _heading(number, line, underlined)
        if found is None:
            yield Text(number, line)
            continue
        heading, rest, took_underline = found
        if took_underline:
            pending.popleft()
        if rest:
            pending.appendleft((number, rest))
        yield heading


def _fence(
    number: int,
    line: str,
    opening: re.Match[str],
    pending: deque[tuple[int, str]],
    source: str | None,
) -> Fence:
    mark, inside = opening[2], []
    while pending:
        _, inner = pending.popleft()
        if _closes(inner, mark):
            break
        inside.append(inner)
    else:
        raise SkillError(
            "the code fence that opens here is never closed",
            source=source,
            line=number,
            expected=f"a line {mark} after the code",
        )
    words = opening[3].split()
    code, skipped = _code(inside, len(opening[1]))
    return Fence(
        line=number + 1 + skipped,
        language=words[0].lower().strip("{}.") if words else "",
        code=code,
        raw="\n".join([line, *inside, inner]),
    )


def _closes(line: str, mark: str) -> bool:
    text = line.strip()
    return len(text) >= len(mark) and set(text) == {mark[0]}


def _code(lines: list[str], indent: int) -> tuple[str, int]:
    """The code of a fence, and how many blank lines were left out before it."""
    margin = re.compile(rf"[ \t]{{0,{indent}}}")
    lines = [margin.sub("", line, count=1) for line in lines]
    while lines and not lines[-1].strip():
        lines.pop()
    skipped = next((i for i, line in enumerate(lines) if line.strip()), 0)
    lines = lines[skipped:]
    text = "\n".join(lines)
    return (textwrap.dedent(text) if lines and lines[0][:1].isspace() else text), skipped


def _heading(number: int, line: str, underlined: bool) -> tuple[Heading, str, bool] | None:
    """The heading on a line, what follows it there, and whether the next line underlines it."""
    if atx := _ATX.fullmatch(line):
        found = _atx(number, atx)
        return (*found, False) if found else None
    if label := _label(line):
        return *_known(number, LABEL_LEVEL, label), False
    title = read_title(line)
    if title and underlined and not title.rest:
        return *_known(number, TEXT_LEVEL, title), True
    if title and _is_plain_label(line, title):
        return *_known(number, LABEL_LEVEL, title), False
    return None


def _atx(number: int, match: re.Match[str]) -> tuple[Heading, str] | None:
    level, space, text = len(match[1]), match[2], match[3].strip().rstrip("#").rstrip()
    if title := _label(text) or read_title(_unmarked(text)):
        return _known(number, level, title)
    return (Heading(number, level, text), "") if space and text else None


def _unmarked(text: str) -> str:
    """A title without emphasis; text that holds a formula or code stays as it is."""
    return text if any(sign in text for sign in "()&|<>") else _MARKS.sub("", text)


def _label(text: str) -> Title | None:
    """Recognise ``**Title**``, ``**Title:** rest`` and the like."""
    match = _BOLD.fullmatch(text)
    if not match:
        return None
    title = read_title(match[2])
    if title is None or not match[3]:
        return title
    rest = f"{title.rest} {match[3]}".strip()
    return Title(title.kind, rest, True)


def _is_plain_label(line: str, title: Title) -> bool:
    """True for ``Title:`` or ``1. Title`` alone on a line, and for ``Skill: name``."""
    if title.kind is Kind.SKILL:
        return title.colon and bool(re.fullmatch(r"[\w -]{0,60}", title.rest))
    return not title.rest and (title.colon or bool(_NUMBERED.match(line)))


def _known(number: int, level: int, title: Title) -> tuple[Heading, str]:
    if title.kind is Kind.SKILL:
        return Heading(number, level, title.rest, title.kind, title.rest), ""
    return Heading(number, level, title.kind.value, title.kind), title.rest
