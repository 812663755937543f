"""Code on an HTML page: numbered listings, and differences between two texts."""

from __future__ import annotations

import difflib
from collections.abc import Mapping

from vaso.report.markup import Markup, el

CLASSES = {"+": "row add", "-": "row del", "@": "row hunk"}


def listing(code: str, marks: Mapping[int, str] | None = None) -> Markup:
    """Numbered lines; each marked one is coloured and says why."""
    marks = marks or {}
    rows = []
    for number, line in enumerate(code.rstrip("\n").split("\n"), start=1):
        why = marks.get(number)
        rows.append(
            el(
                "span",
                el("span", number, cls="no"),
                line,
                el("span", f"← {why}", cls="why") if why else None,
                cls="row" if why is None else "row marked",
            )
        )
    return _block(rows)


def difference(before: str, after: str, *, context: int = 3) -> Markup:
    """The changed lines of a text with some context."""
    lines = difflib.unified_diff(before.splitlines(), after.splitlines(), n=context, lineterm="")
    return diff_block("\n".join(list(lines)[2:]))


def diff_block(diff: str) -> Markup:
    """A unified diff with its colours."""
    rows = [el("span", line or " ", cls=_class(line)) for line in diff.splitlines()]
    return _block(rows) if rows else el("p", "Nothing changed.", cls="soft")


def _class(line: str) -> str:
    return "row hunk" if line.startswith(("+++ ", "--- ")) else CLASSES.get(line[:1], "row")


def _block(rows: list[Markup]) -> Markup:
    return el("div", el("pre", rows), cls="listing scroll")
