"""What the behaviours of a plan use of it, in words and as a listing."""

from __future__ import annotations

from rich.console import Group
from rich.padding import Padding
from rich.text import Text

from vaso.report.markup import Markup, el, join
from vaso.verification.coverage import Coverage
from vaso.verification.coverage_text import more, told

__all__ = ["coverage_notes", "coverage_section", "coverage_view"]

NEVER, UNKNOWN = "✗", "?"
LEGEND = {NEVER: "never runs", UNKNOWN: "not known whether it runs"}


def coverage_notes(coverage: Coverage | None) -> list[Text]:
    """Lines for the terminal below a verdict."""
    found = told(coverage) if coverage else ()
    return [Text(f"coverage: {text}", style="yellow") for text in found]


def coverage_view(coverage: Coverage, plan: str) -> Group:
    """The whole of it for the terminal: the plan with marks, and everything there is to say."""
    ran, all_lines = len(coverage.executed), _all(coverage)
    head = f"\n{ran} of {len(all_lines)} lines with code run"
    marks = dict.fromkeys(coverage.never, NEVER) | dict.fromkeys(coverage.unknown, UNKNOWN)
    listed = Text()
    for number, line in enumerate(plan.rstrip("\n").split("\n"), start=1):
        mark = marks.get(number, " ")
        listed.append(f"{mark} {number:>3} │ ", style="yellow" if mark != " " else "dim")
        listed.append(f"{line}\n", style="dim" if mark == NEVER else "")
    listed.rstrip()
    below = [f"{m}: {w}" for m, w in LEGEND.items() if m in marks.values()]
    below += [f"{text[0].upper()}{text[1:]}." for text in more(coverage)]
    return Group(Text(head), Padding(listed, (0, 0, 0, 1)), *map(Text, below))


def coverage_section(coverage: Coverage | None) -> Markup:
    """The same for a page, above the plan; nothing where there is nothing to say."""
    found = [*told(coverage), *more(coverage)] if coverage else []
    if not found:
        return Markup()
    return join(el("h2", "What the plan does not use"), el("ul", [el("li", t) for t in found]))


def _all(coverage: Coverage) -> list[int]:
    return sorted({*coverage.executed, *coverage.never, *coverage.unknown})
