"""Progress of a comparison: a bar over its runs, with the time that is left."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Console

from vaso.cli.progress import Progress

if TYPE_CHECKING:
    from vaso.comparison import RunEvent


class ComparisonProgress(Progress):
    """A listener for the events of a comparison."""

    def __init__(
        self, steps: int, *, console: Console | None = None, delay: float | None = None
    ) -> None:
        """Set up.

        Args:
            steps: How many steps a run makes at most.
            console: Where to show progress; standard error by default.
            delay: Seconds until it shows; two by default.
        """
        super().__init__("starting", console=console, delay=delay)
        self._steps = steps
        self._found: int | None = None
        self._shares: dict[tuple[str, int], float] = {}

    def __call__(self, told: RunEvent) -> None:
        """Show an event."""
        if self._found is None:
            self._found = told.done - (told.event is None)
        key = told.optimizer, told.seed
        step = told.event.step if told.event else 0
        if told.event is None:
            self._shares.pop(key, None)
        elif step:
            self._shares[key] = step / (self._steps + 1)
        text = f"{told.done} of {told.runs} runs, {told.optimizer}, seed {told.seed}"
        text += f", step {step}" if step else ""
        # Runs that were found on resuming took no time.
        done = told.done + sum(self._shares.values()) - self._found
        self.update(text, done=done, total=told.runs - self._found)
