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
from vaso.ltl import Constant, Proposition, parse_with_warnings
from vaso.skill import Role, Rule
from vaso.skill_file.markdown import Block, Fence, Text
from vaso.skill_file.titles import Kind, read_title

ROLES: dict[Kind, Role] = {
    Kind.GLOBAL: "global",
    Kind.LOCAL: "local",
    Kind.ASSUMPTIONS: "assumption",
}

_BULLET = re.compile(r"\s*(?:[-*+•–]|\(?(?:\d{1,3}|[a-z])[.)])\s+(?=\S)")
_SPAN = re.compile(r"(\*\*|__|\*)?(`{1,3}|\${1,2}|\*\*|__)(?=\S)(.+?)\2(\*\*|__|\*)?", re.DOTALL)
_LABEL = re.compile(
    r"\s*(?P<label>[^`$:=]{1,200}?)\s*(?P<sign>:=|[:=–—]|\s-\s)(?:\*\*|__)?\s*(?=\S)"
)
_REMARK = re.compile(r"\s{0,4}(?:#|//|--|[–—;,:]|<!--|\s-\s|\.\s|\s\(|\n|$)")
_SEPARATORS = " \t,;:.–—-#/"
_ARROW = re.compile(r"<?->|[=⇔↔→⇒⟹⟶⊃]>|[⇔↔→⇒⟹⟶⊃]|\\(?:right|left|Right)\w*arrow|\\to\b|\\implies\b")
_OPERATOR = re.compile(r"->|=>|[→⇒&|∧∨¬!~<>=≤≥]|\\\w|\b(?:and|or|not|until|implies|[URVWST])\b")
_LETTERS = re.compile(r"[\s(\[{¬!~]*(?:[GFXHOYZ]\s*)+(?P<end>[(\[{¬!~\\]|(?<=\s)(?=[a-z_]))")
_SYMBOLS = re.compile(
    r"[\s(\[{¬!~]*(?:\[\s*\]|<>|[□◻◇◊○◯⃞𝐆𝐅𝐗]|\\(?:Box|Diamond|square|bigcirc|mathbf)\b)"
)
_WORDS = re.compile(r"[\s(\[{¬!~]*(?:always|globally|eventually|finally|next)\b\s*", re.IGNORECASE)
_COMPARISON = re.compile(r"[a-z_][\w ]{0,60}\(?\)?\s*(?:[<>≤≥]|[<>=!]=|=)\s*-?\d[\d.]*\s*[\w/^²]*")
_NONE = re.compile(
    r"\W*(?:none|n/a|nothing|no (?:\w+ ){0,3}(?:rules?|contracts?|assumptions?))\W*", re.I
)
_OPEN_END = re.compile(r"(?:->|→|⇒|=>|[&|∧∨,(¬!])\s*$")
_OPEN_START = re.compile(r"\s*(?:->|→|⇒|=>|[&|∧∨)])")
_SIGN = re.compile(r"[&|∧∨¬!~<>=≤≥→⇒]")
_STOP = re.compile(r"[;,#:(—–]|--|//")
_CODE = re.compile(r"^\s*(?:def|class|import|from|while|for|if|return)\b.*$", re.MULTILINE)
_DECORATION = re.compile(r"[\s=*_#\-–—~+]*")
_COMMENT = re.compile(r"\s*(?:#|//|--|==+)")
_QUOTED = re.compile(r"`[^`]*(?:`|$)|<!--.*?(?:-->|$)", re.DOTALL)
MAX_LINE = 10_000
MAX_REMARKED = 2_000
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
    return _tidy(line[start.end() :].rstrip(" =")) if start else None


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
    is_row, is_item = text.startswith("|"), text != line.text.strip()
    found = None if is_row else _labelled(text, is_item) or _formula(text, certain)
    if is_row or (is_item and not found):
        found = _embedded(text)
    if not found and certain:
        found = _Found(text, "")
    return list(_rules(found, line, role, source)) if found else []


@dataclass
class _Found:
    """A formula's text and what stands behind it."""

    text: str
    note: str
    delimited: bool = False


def _labelled(text: str, is_item: bool) -> _Found | None:
    """A formula with a name in front of it, as in ``Rule 4: G(a)``; the name becomes the note."""
    match = _LABEL.match(text)
    if not match or _SIGN.search(match["label"]) or looks_like_formula(match["label"]):
        return None
    rest = text[match.end() :]
    found = _formula(rest)
    if found is None or (match["sign"] == "=" and not (found.delimited or _is_temporal(rest))):
        return None
    if found.delimited and not is_item and len(match["label"].split()) > 6:
        return None  # a sentence about a formula
    found.note = f"{match['label'].strip('*_ ')}: {_tidy(found.note)}".rstrip(": ")
    return found


def _embedded(text: str) -> _Found | None:
    """The one formula inside a list item or table row: ``- people: stop at once, `G(a)```."""
    if text.startswith("|") and "`" not in text:
        found = [c for c in map(str.strip, text.split("|")) if looks_like_formula(c)]
        note = " ".join(c.strip() for c in text.split("|") if c.strip() not in found)
    else:
        spans = [m for m in _SPAN.finditer(text) if looks_like_formula(m[3])]
        found = [m[3].strip() for m in spans]
        note = text.replace(spans[0][0], "").replace("|", " ") if spans else ""
    return _Found(found[0], note, delimited=True) if len(found) == 1 else None


def _is_temporal(text: str) -> bool:
    return bool(_LETTERS.match(text) or _SYMBOLS.match(text))


def _formula(text: str, certain: bool = False) -> _Found | None:
    if span := _SPAN.match(text):
        inner, rest = span[3].strip(), text[span.end() :]
        alone = "`" in span[2] and not rest.strip(_SEPARATORS)
        certain &= not rest and span[2] != "__"  # which may be part of a name
        if alone or certain or is_recognised(inner):
            return _Found(inner, rest, delimited=True)
    return _Found(text, "") if looks_like_formula(text) else None


def looks_like_formula(text: str) -> bool:
    """Tell whether a text is meant as a formula, however badly it may be written."""
    bare = _QUOTED.sub("", text)
    if _ARROW.search(bare) or _SYMBOLS.match(bare) or _COMPARISON.fullmatch(text.strip(" .;,")):
        return True
    if letters := _LETTERS.match(bare):
        following = bare[letters.end() :]
        words = _STOP.split(following, maxsplit=1)[0].split()
        return bool(letters["end"] or _OPERATOR.search(following) or len(words) <= 3)
    return bool(_WORDS.match(bare) and _OPERATOR.search(bare))


def is_recognised(text: str) -> bool:
    """Tell a formula between backticks from a single name, which may be there as a word.

    Args:
        text: The text between the backticks.
    """
    if looks_like_formula(text):
        return True
    if not _OPERATOR.search(text):
        return False
    try:
        return not isinstance(parse_with_warnings(text).formula, Proposition | Constant)
    except FormulaError:
        return False


def _rules(found: _Found, line: Text, role: Role, source: str | None) -> Iterator[Rule]:
    text, note = found.text, found.note
    if not found.delimited:
        text, note = _split_remark(text, note)
    text = text.strip("` \n")
    _check(text, line, source)
    further = _further(note)
    yield Rule(text=_one_line(text), role=role, note="" if further else _tidy(note))
    if further:
        yield from _rules(further, line, role, source)


def _further(note: str) -> _Found | None:
    """Another formula on the same line: ``G(a), G(b)``."""
    rest = re.sub(rf"^[{re.escape(_SEPARATORS)}]*(?:(?:and|&)\s)?\s*", "", note)
    found = _formula(rest)
    return found if found and (found.delimited or _is_temporal(rest)) else None


def _split_remark(text: str, note: str) -> tuple[str, str]:
    """Cut a remark off a formula that has no delimiters: the longest part that can be read."""
    ends = [len(text)]
    if len(text) <= MAX_REMARKED:
        ends = sorted({m.start() for m in _REMARK.finditer(text)}, reverse=True)
    for end in ends[:20]:
        head = text[:end].rstrip(" \t.;,")
        if head and _error(head) is None:
            remark = text[end:].strip()
            return head, f"{remark} {note}" if note else remark
    shortest = next((text[:e] for e in reversed(ends) if _is_hard(text, e)), text)
    return shortest, note


def _is_hard(text: str, end: int) -> bool:
    return bool(re.match(r"\s*(?:#|//|--|[–—])", text[end:])) and bool(text[:end].strip())


def _error(text: str) -> FormulaError | None:
    try:
        parse_with_warnings(text)
    except FormulaError as error:
        return error
    return None


def _check(text: str, line: Text, source: str | None) -> None:
    """Raise the parser's error at its place in the file."""
    error = _error(text)
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


def _tidy(note: str) -> str:
    note = _one_line(note).lstrip(_SEPARATORS)
    if note.startswith("(") and note.endswith(")") and note.count("(") == 1:
        note = note[1:-1].strip()
    return note.lstrip(_SEPARATORS)
