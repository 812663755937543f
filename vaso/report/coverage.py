"""What the behaviours of a plan use of it, in words and as a listing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from rich.console import Group
from rich.padding import Padding
from rich.text import Text

from vaso.report.markup import Markup, el, join
from vaso.verification.coverage import Coverage

__all__ = ["coverage_notes", "coverage_section", "coverage_view", "told"]

NEVER, UNKNOWN = "✗", "?"
LEGEND = {NEVER: "never runs", UNKNOWN: "not known whether it runs"}


def told(coverage: Coverage) -> Iterator[str]:
    """What an author should know, one sentence each; nothing where the plan uses all it has."""
    so_far = "" if coverage.steps is None else f" in the first {coverage.steps} steps"
    if coverage.never:
        verb = "never run" if coverage.steps is None else "do not run"
        yield _of_lines(coverage.never, verb) + so_far
    for branch in coverage.branches:
        yield f"line {branch.line}: {branch.text}{so_far}"
    for name in coverage.unheeded:
        yield f"the plan reads {name}, but what it says never changes what the robot does"
    for name in coverage.unread:
        yield f"a rule speaks of {name}, which the plan does not read{so_far}"


def more(coverage: Coverage) -> Iterator[str]:
    """What is worth a look only on request."""
    so_far = "" if coverage.steps is None else f" in the first {coverage.steps} steps"
    for name in coverage.idle_actions:
        yield f"a rule speaks of {name}, which the plan does not do{so_far}"
    if coverage.unknown:
        text = _of_lines(coverage.unknown, "run")
        yield f"it is not known whether {text}: {coverage.reason}"


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


def _of_lines(lines: Sequence[int], verb: str) -> str:
    """A sentence about lines: line 3 never runs, lines 3–5 and 7 never run."""
    if len(lines) == 1:
        singular = {"never run": "never runs", "do not run": "does not run", "run": "runs"}[verb]
        return f"line {lines[0]} {singular}"
    return f"lines {_ranges(lines)} {verb}"


def _ranges(lines: Iterable[int]) -> str:
    runs: list[list[int]] = []
    for line in sorted(lines):
        if runs and runs[-1][1] == line - 1:
            runs[-1][1] = line
        else:
            runs.append([line, line])
    texts = [str(a) if a == b else f"{a}–{b}" for a, b in runs]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} and {texts[-1]}"
