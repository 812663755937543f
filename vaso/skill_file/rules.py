"""Finding the formulas in a section of a skill file, and telling them from the text around them.

A formula may stand in a list, a fence, backticks or bold print, with a name in front of it and a
remark behind it. What looks like a formula and cannot be read is an error, never text: a rule
must not get lost.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from vaso.errors import FormulaError, SkillError
from vaso.skill import Role, Rule
from vaso.skill_file.formulas import (
    Found,
    find_error,
    find_formulas,
    further_formula,
    looks_like_formula,
    split_remark,
    tidy_note,
)
from vaso.skill_file.markdown import Block, Fence, Text
from vaso.skill_file.titles import Kind, read_title

ROLES: dict[Kind, Role] = {
    Kind.GLOBAL: "global",
    Kind.LOCAL: "local",
    Kind.ASSUMPTIONS: "assumption",
}

_BULLET = re.compile(r"\s*(?:[-*+•–]|\(?(?:\d{1,3}|[a-z])[.)])\s+(?=\S)")
_NONE = re.compile(
    r"\W*(?:none|n/a|nothing|no (?:\w+ ){0,3}(?:rules?|contracts?|assumptions?))\W*", re.I
)
_OPEN_END = re.compile(r"(?:->|→|⇒|=>|[&|∧∨,(¬!])\s*$")
_OPEN_START = re.compile(r"\s*(?:->|→|⇒|=>|[&|∧∨)])")
_CODE = re.compile(r"^\s*(?:def|class|import|from|while|for|if|return)\b.*$", re.MULTILINE)
_DECORATION = re.compile(r"[\s=*_#\-–—~+]*")
_COMMENT = re.compile(r"\s*(?:#|//|--|==+)")
MAX_LINE = 10_000
MAX_RULES = 300


@dataclass
class RuleSection:
    """What a section for formulas holds.

    Attributes:
        rules: The formulas.
        prose: Lines of text around them.
        is_none: True when it says that there are none.
    """

    rules: list[Rule] = field(default_factory=list)
    prose: list[str] = field(default_factory=list)
    is_none: bool = False


def read_rules(blocks: Sequence[Block], kind: Kind, source: str | None) -> RuleSection:
    """Read the content of a Global Contract, Local Contract or Environment Assumptions section.

    Args:
        blocks: The section's lines and fences.
        kind: Which of the three.
        source: The file, for messages.

    Raises:
        SkillError: Something looks like a formula and cannot be read.
    """
    found = RuleSection()
    for part in _parts(blocks):
        if isinstance(part, Fence):
            _read_fence(part, kind, source, found)
        elif rules := _read_line(part, ROLES[kind], source):
            found.rules += rules
        elif _NONE.fullmatch(part.text):
            found.is_none = True
        elif not _DECORATION.fullmatch(part.text) or not part.text.strip():
            found.prose += part.text.split("\n")
        if len(found.rules) > MAX_RULES:
            raise SkillError(
                f"more than {MAX_RULES} formulas in one section", source=source, line=part.line
            )
    return found


def _parts(blocks: Iterable[Block]) -> Iterator[Text | Fence]:
    """Fences and lines, where a formula or list item that runs over several lines is one line."""
    for is_text, group in itertools.groupby(blocks, key=lambda block: isinstance(block, Text)):
        if is_text:
            yield from _joined(block for block in group if isinstance(block, Text))
        else:
            yield from (block for block in group if isinstance(block, Fence))


def _joined(lines: Iterable[Text]) -> Iterator[Text]:
    waiting: Text | None = None
    for line in lines:
        if waiting and _continues(waiting.text, line.text):
            waiting = Text(waiting.line, f"{waiting.text}\n{line.text}")
            continue
        if waiting:
            yield waiting
        waiting = line
    if waiting:
        yield waiting


def _continues(before: str, line: str) -> bool:
    if not before.strip() or not line.strip() or _BULLET.match(line) or len(before) > MAX_LINE:
        return False
    if _COMMENT.match(before):
        return False  # a stray backtick in a comment must not swallow the rule below it
    if before.count("`") % 2 and "```" not in before:
        return True
    if _BULLET.match(before) and line[:2].isspace():
        return True
    if not looks_like_formula(_without_bullet(before)):
        return False
    return _is_open(before) or bool(_OPEN_START.match(line))


def _without_bullet(text: str) -> str:
    bullet = _BULLET.match(text)
    return text[bullet.end() :] if bullet else text


def _is_open(text: str) -> bool:
    return text.count("(") > text.count(")") or bool(_OPEN_END.search(text))


def _read_fence(fence: Fence, kind: Kind, source: str | None, found: RuleSection) -> None:
    """Every line of a fence is a formula or a comment; a comment may name another section."""
    if _CODE.search(fence.code):
        found.prose += fence.raw.split("\n")
        return
    rules: list[Rule] = []
    remark = ""
    for line in _joined(Text(fence.line + i, t) for i, t in enumerate(fence.code.split("\n"))):
        comment = _comment(line.text)
        title = read_title(comment) if comment else None
        if title and title.kind in ROLES:
            kind = title.kind
        elif comment is not None:
            remark = f"{remark} {comment}".strip()
        elif line.text.strip():
            read = _read_line(line, ROLES[kind], source, certain=True)
            rules += [r.model_copy(update={"note": r.note or remark}) for r in read]
            remark = ""
    if remark and rules:
        rules[-1] = rules[-1].model_copy(update={"note": f"{rules[-1].note} {remark}".strip()})
    found.rules += rules
    if not rules:
        found.prose += fence.raw.split("\n")


def _comment(line: str) -> str | None:
    start = _COMMENT.match(line)
    return tidy_note(line[start.end() :].rstrip(" =")) if start else None


def _read_line(line: Text, role: Role, source: str | None, *, certain: bool = False) -> list[Rule]:
    """The formulas on a line, or nothing where it is text.

    Args:
        line: The line, or several that belong together.
        role: The role of the formulas.
        source: The file, for messages.
        certain: True where only formulas can stand.
    """
    text = _without_bullet(line.text).strip()
    if len(text) > MAX_LINE:
        raise SkillError(
            "this line is too long", source=source, line=line.line, expected="one formula a line"
        )
    is_item = text != line.text.strip()
    found = find_formulas(text, is_item=is_item, certain=certain)
    return [rule for one in found for rule in _rules(one, line, role, source)]


def _rules(found: Found, line: Text, role: Role, source: str | None) -> Iterator[Rule]:
    text, note = found.text, found.note
    if not found.delimited:
        text, note = split_remark(text, note)
    text = text.strip("` \n")
    _check(text, line, source)
    further = further_formula(note)
    yield Rule(text=_one_line(text), role=role, note="" if further else tidy_note(note))
    if further:
        yield from _rules(further, line, role, source)


def _check(text: str, line: Text, source: str | None) -> None:
    """Raise the parser's error at its place in the file."""
    error = find_error(text)
    if error is None and "`" in text:
        error = FormulaError("there is a backtick inside the formula", line=1)
    if error is None:
        return
    row = (error.line or 1) - 1
    first = text.split("\n")[row]
    rows = line.text.split("\n")
    at = next((i for i, r in enumerate(rows) if first and first in r), 0)
    column = rows[at].find(first) + (error.column or 1)
    raise SkillError(
        f"a rule cannot be read: {error.message}",
        source=source,
        line=line.line + at,
        column=column if first in rows[at] else None,
        expected=error.expected,
        hint=error.hint,
    ) from error


def _one_line(text: str) -> str:
    return " ".join(text.split())
