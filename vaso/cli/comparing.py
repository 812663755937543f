"""Progress of a comparison: a bar over its runs, with the time that is left."""

from __future__ import annotations

import time
from types import TracebackType
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn

if TYPE_CHECKING:
    from vaso.comparison import RunEvent


class ComparisonProgress:
    """A listener for the events of a comparison.

    Where standard error is not a terminal it shows nothing.
    """

    def __init__(self, console: Console, steps: int) -> None:
        """Set up.

        Args:
            console: Where to show progress.
            steps: How many steps a run makes at most.
        """
        self._steps = steps
        self._start = time.monotonic()
        self._found: int | None = None
        self._shares: dict[tuple[str, int], float] = {}
        self._bar = Progress(
            BarColumn(20),
            TextColumn("{task.description}"),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task("starting", total=None)

    def __enter__(self) -> ComparisonProgress:
        """Start showing."""
        self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop showing, and clear the line."""
        self._bar.stop()

    def __call__(self, told: RunEvent) -> None:
        """Show an event."""
        if self._found is None:
            self._found = told.done - (told.event is None)
        key = told.optimizer, told.seed
        step = told.event.step if told.event else 0
        self._shares[key] = step / (self._steps + 1)
        if told.event is None:
            del self._shares[key]
        now = told.done + sum(self._shares.values())
        text = f"{told.done} of {told.runs} runs · {told.optimizer}, seed {told.seed}"
        text += f", step {step}" if step else ""
        self._bar.update(
            self._task,
            total=told.runs,
            completed=now,
            description=escape(text + self._left(now - self._found, told.runs - now)),
        )

    def _left(self, done: float, left: float) -> str:
        """Time left, if each share of the work takes as long as those before."""
        elapsed = time.monotonic() - self._start
        if done <= 0 or elapsed < 1:
            return ""
        seconds = elapsed / done * left
        shown = f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"
        return f" · about {shown} left"
