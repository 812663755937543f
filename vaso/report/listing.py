"""Code on an HTML page: numbered listings, and differences between two texts."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Iterator, Mapping

from vaso.report.markup import Markup, el

HUNK = re.compile(r"@@ -(\d+)(?:,(\d+))? \+(\d+)(?:,(\d+))? @@")
CLASSES = {"+": "row add", "-": "row del", " ": "row"}


def listing(
    code: str, marks: Mapping[int, str] | None = None, faded: Collection[int] = ()
) -> Markup:
    """Numbered lines; each marked one is coloured and says why, and some are set in grey."""
    marks = marks or {}
    rows = []
    for number, line in enumerate(code.rstrip("\n").split("\n"), start=1):
        why = marks.get(number)
        rows.append(
            el(
                "span",
                el("span", number, cls="no"),
                el("span", "→" if number in marks else "", cls="arrow"),
                line,
                el("span", f"← {why}", cls="why") if why else None,
                cls=_row_class(why is not None, number in faded),
            )
        )
    return _block(rows)


def _row_class(marked: bool, faded: bool) -> str:
    return f"row{' marked' if marked else ''}{' faded' if faded else ''}"


def difference(before: str, after: str, *, context: int = 3) -> Markup:
    """The changed lines of a text with some context."""
    lines = difflib.unified_diff(before.splitlines(), after.splitlines(), n=context, lineterm="")
    return diff_block("\n".join(lines))


def diff_block(diff: str) -> Markup:
    """A unified diff of one or more texts: lines with their numbers, added and removed ones marked.

    The name of a text stands above its lines, and a gap for what is left out between them.
    """
    rows = list(_diff_rows(diff))
    return _block(rows) if rows else el("p", "Nothing changed.", cls="soft")


def _diff_rows(diff: str) -> Iterator[Markup]:
    old = new = old_end = new_end = 0
    first = True
    for line in diff.splitlines():
        if old < old_end or new < new_end:
            sign = line[:1] or " "
            yield _diff_row(sign, old if sign == "-" else new, line[1:])
            old, new = old + (sign != "+"), new + (sign != "-")
        elif line.startswith("+++") and line[3:].strip():
            yield el("span", _title(line[3:].strip()), cls="row title")
            first = True
        elif found := HUNK.match(line):
            old, new = int(found[1]), int(found[3])
            old_end, new_end = old + int(found[2] or 1), new + int(found[4] or 1)
            if not first:
                yield el("span", "⋮", cls="row hunk")
            first = False


def _diff_row(sign: str, number: int, text: str) -> Markup:
    parts = (el("span", number, cls="no"), el("span", sign, cls="sign"), text)
    return el("span", *parts, cls=CLASSES.get(sign, "row"))


def _title(name: str) -> str:
    return name.replace("_", " ").capitalize() if name else ""


def _block(rows: list[Markup]) -> Markup:
    return el("div", el("pre", rows), cls="listing scroll", tabindex=0)
