"""Coverage in words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from vaso.verification.coverage import Coverage

__all__ = ["more", "told"]


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
