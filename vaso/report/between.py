"""What is known between samples: a line for each numeric rule."""

from __future__ import annotations

from collections.abc import Sequence

from rich.padding import Padding
from rich.text import Text

from vaso.dynamics.result import BetweenSamples
from vaso.report.markup import Markup, el
from vaso.verdict import Verdict

__all__ = ["between_section", "between_views"]

MARKS = {Verdict.PASS: ("✓", "green"), Verdict.FAIL: ("✗", "bold red")}
OPEN = ("?", "yellow")


def between_views(found: Sequence[BetweenSamples]) -> list[Padding | Text]:
    """For the terminal: the class of vehicles, then one line a rule."""
    told = [_line(b) for b in found if b.verdict is not Verdict.UNSUPPORTED]
    if not told and not _without_response(found):
        return []
    rest = _rest(found)
    return [
        Text(_head(found), style="bold"),
        *(Padding(line, (0, 0, 0, 1)) for line in told),
        *([Padding(Text(rest, style="dim"), (0, 0, 0, 1))] if rest else []),
        Text(),
    ]


def between_section(found: Sequence[BetweenSamples]) -> Markup:
    """For a page: what the terminal says, and why some rules are left out."""
    if not found:
        return Markup()
    rows = [el("p", el("code", b.spec), f" {_mark(b)[0]} {b.text}.") for b in found]
    return el("div", el("h2", "Between samples"), el("p", _head(found), cls="soft"), rows)


def _head(found: Sequence[BetweenSamples]) -> str:
    if _without_response(found):
        return f"Between samples: {found[0].reason}."
    return f"Between samples, for every vehicle that {found[0].vehicle}:"


def _without_response(found: Sequence[BetweenSamples]) -> bool:
    return bool(found) and not any(b.vehicle for b in found)


def _line(found: BetweenSamples) -> Text:
    mark, style = _mark(found)
    return Text(f"{mark} ", style=style).append(found.text, style="default not bold")


def _rest(found: Sequence[BetweenSamples]) -> str:
    left = sum(b.verdict is Verdict.UNSUPPORTED for b in found)
    if not left or _without_response(found):
        return ""
    rules = "1 rule with numbers is" if left == 1 else f"{left} rules with numbers are"
    return f"– {rules} about samples only (--json says why)"


def _mark(found: BetweenSamples) -> tuple[str, str]:
    return MARKS.get(found.verdict, OPEN)
