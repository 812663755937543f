"""Recognising formulas in running text: what is a formula, what its name, what a remark on it."""

from __future__ import annotations

import re
from dataclasses import dataclass

from vaso.errors import FormulaError
from vaso.ltl import Constant, Proposition, parse_with_warnings

_SPAN = re.compile(
    r"(\*\*|__|\*)?(`{1,3}|\${1,2}|\*\*|__)(?:(?<=`)\s*|(?=\S))(.+?)\2(\*\*|__|\*)?", re.DOTALL
)
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
_LETTER_WORD = re.compile(r"(?<!\w)[GFXUW]+(?!\w)")
_NAME = re.compile(r"\b[a-z_]\w+")
_SIGN = re.compile(r"[&|∧∨¬!~<>=≤≥→⇒]")
_STOP = re.compile(r"[;,#:(—–]|--|//")
_QUOTED = re.compile(r"`[^`]*(?:`|$)|<!--.*?(?:-->|$)", re.DOTALL)
MAX_REMARKED = 2_000


@dataclass
class Found:
    """A formula's text and what stands behind it."""

    text: str
    note: str
    delimited: bool = False


def find_formulas(text: str, *, is_item: bool, certain: bool) -> list[Found]:
    """The formulas in a line; nothing where it is text.

    Args:
        text: The line without its bullet.
        is_item: True for a list item.
        certain: True where only formulas can stand.
    """
    is_row = text.startswith("|")
    found = None if is_row else _labelled(text, is_item) or _formula(text, certain)
    if found:
        return [found]
    if is_row or is_item:
        inside = _embedded(text)
        return inside or ([Found(text, "")] if certain else [])
    return [Found(text, "")] if certain else []


def _labelled(text: str, is_item: bool) -> Found | None:
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
    found.note = f"{match['label'].strip('*_ ')}: {tidy_note(found.note)}".rstrip(": ")
    return found


def _embedded(text: str) -> list[Found]:
    """The formulas inside a list item or table row: ``- people: stop at once, `G(a)`, always``."""
    if text.startswith("|") and "`" not in text:
        cells = [c.strip() for c in text.split("|")]
        found = [c for c in cells if looks_like_formula(c)]
        note = " ".join(c for c in cells if c not in found)
    else:
        spans = [m for m in _SPAN.finditer(text) if looks_like_formula(m[3])]
        found = [m[3].strip() for m in spans]
        note = text
        for span in spans:
            note = note.replace(span[0], "").replace("|", " ")
    return [Found(f, "" if i else note, delimited=True) for i, f in enumerate(found)]


def _is_temporal(text: str) -> bool:
    return bool(_LETTERS.match(text) or _SYMBOLS.match(text))


def _formula(text: str, certain: bool = False) -> Found | None:
    if span := _SPAN.match(text):
        inner, rest = span[3].strip(), text[span.end() :]
        alone = "`" in span[2] and not rest.strip(_SEPARATORS)
        certain &= not rest and span[2] != "__"  # which may be part of a name
        if alone or certain or is_recognised(inner):
            return Found(inner, rest, delimited=True)
    return Found(text, "") if looks_like_formula(text) else None


def looks_like_formula(text: str) -> bool:
    """Tell whether a text is meant as a formula, however badly it may be written.

    Args:
        text: A line, or what stands between backticks.
    """
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

    Names around a temporal operator are a formula even if they cannot be read: a rule must not get
    lost.

    Args:
        text: The text between the backticks.
    """
    if looks_like_formula(text):
        return True
    broken = bool(_LETTER_WORD.search(text)) and len(_NAME.findall(text)) > 1
    if not _OPERATOR.search(text):
        return broken
    try:
        return not isinstance(parse_with_warnings(text).formula, Proposition | Constant)
    except FormulaError:
        return broken


def further_formula(note: str) -> Found | None:
    """Find another formula in what follows one: ``G(a), G(b)``.

    Args:
        note: What follows the first formula.
    """
    rest = re.sub(rf"^[{re.escape(_SEPARATORS)}]*(?:(?:and|&)\s)?\s*", "", note)
    found = _formula(rest)
    return found if found and (found.delimited or _is_temporal(rest)) else None


def split_remark(text: str, note: str) -> tuple[str, str]:
    """Cut a remark off a formula that has no delimiters: the longest part that can be read.

    Args:
        text: The formula, perhaps with a remark behind it.
        note: What is known already to follow.

    Returns:
        The formula's text and the remark.
    """
    ends = [len(text)]
    if len(text) <= MAX_REMARKED:
        ends = sorted({m.start() for m in _REMARK.finditer(text)}, reverse=True)
    for end in ends[:20]:
        head = text[:end].rstrip(" \t.;,")
        if head and find_error(head) is None:
            remark = text[end:].strip()
            return head, f"{remark} {note}" if note else remark
    shortest = next((text[:e] for e in reversed(ends) if _is_hard(text, e)), text)
    return shortest, note


def _is_hard(text: str, end: int) -> bool:
    return bool(re.match(r"\s*(?:#|//|--|[–—])", text[end:])) and bool(text[:end].strip())


def find_error(text: str) -> FormulaError | None:
    """What keeps a text from being a formula, or None.

    Args:
        text: The text.
    """
    try:
        parse_with_warnings(text)
    except FormulaError as error:
        return error
    return None


def tidy_note(note: str) -> str:
    """A remark on one line, without the signs that set it off from its formula.

    Args:
        note: The remark as it stands in the file.
    """
    note = " ".join(note.split()).lstrip(_SEPARATORS)
    if note.startswith("(") and note.endswith(")") and note.count("(") == 1:
        note = note[1:-1].strip()
    return note.lstrip(_SEPARATORS)
