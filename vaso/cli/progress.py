"""Progress of a long command: one changing line on the terminal, gone at the end.

It appears after two seconds and on standard error only. Where that is not a terminal, or one that
cannot move its cursor, nothing is shown at all.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING

from rich.console import Console, RenderableType
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.spinner import Spinner
from rich.table import Table
from rich.text import Text

from vaso.cli.common import console as make_console

if TYPE_CHECKING:
    from typing import Self

    from vaso.optimizers.events import Event
    from vaso.plan.explore import Budget

DELAY = 2.0
WIDTH = 20


class Progress:
    """What a command is doing, how long it has been at it, and for how long it still may be.

    The time that is left is told only where it is known: from the share that is done, where all
    parts take about as long, or as a bound, where there is a limit.
    """

    def __init__(
        self,
        text: str = "",
        *,
        limit: float | None = None,
        console: Console | None = None,
        delay: float | None = None,
        early: bool = False,
    ) -> None:
        """Set up.

        Args:
            text: What is being done.
            limit: Seconds after which it ends in any case.
            console: Where to show progress; standard error by default.
            delay: Seconds until it shows; two by default.
            early: True where it may end before everything is done.
        """
        self._console = console or make_console(stderr=True)
        self._text, self._detail, self._limit = text, "", limit
        self._delay = DELAY if delay is None else delay
        self._done, self._total = 0.0, 0.0
        self._first: tuple[float, float] | None = None
        self._last: tuple[float, float] | None = None
        self._about = "up to" if early else "about"
        self._start = self._began = time.monotonic()
        self._spinner = Spinner("dots")
        self._live: Live | None = None
        self._timer: threading.Timer | None = None
        self._lock = threading.RLock()

    def __enter__(self) -> Self:
        """Begin; the line shows later, if it comes to that."""
        self._start = self._began = time.monotonic()
        if _can_move(self._console):
            self._timer = threading.Timer(self._delay, self._show)
            self._timer.daemon = True
            self._timer.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop showing, and clear the line."""
        with self._lock:
            if self._timer:
                self._timer.cancel()
            self._timer = None
            self._hide()

    def update(
        self,
        text: str | None = None,
        *,
        detail: str | None = None,
        done: float | None = None,
        total: float | None = None,
        limit: float | None = None,
    ) -> None:
        """Say how far it is.

        Args:
            text: What is being done.
            detail: What happened last; cut off where the line is too short.
            done: How much of the total is done.
            total: How much there is to do, in parts that take about the same time.
            limit: Seconds from now after which this ends in any case.
        """
        self._text = self._text if text is None else text
        self._detail = self._detail if detail is None else detail
        self._total = self._total if total is None else total
        if done is not None and done != self._done:
            self._done = done
            # The first part also takes what comes before it; the time is told from the ones after.
            self._last = time.monotonic(), done
            self._first = self._first or self._last
        if limit is not None:
            self._began, self._limit = time.monotonic(), limit

    @contextmanager
    def aside(self) -> Iterator[None]:
        """Clear the line while something is printed."""
        with self._lock:
            shown = self._live is not None
            self._hide()
            try:
                yield
            finally:
                if shown:
                    self._show()

    def line(self) -> str:
        """What the line says now."""
        elapsed = time.monotonic() - self._start
        parts = (self._text, duration(elapsed), self._left(), self._detail)
        return " · ".join(p for p in parts if p)

    def _left(self) -> str:
        now = time.monotonic()
        if self._total and self._first and self._last and self._last[1] > self._first[1]:
            pace = (self._last[0] - self._first[0]) / (self._last[1] - self._first[1])
            rest = pace * (self._total - self._done) - (now - self._last[0])
            return f"{self._about} {duration(rest)} left" if rest > 0 else ""
        rest = 0.0 if self._limit is None else self._limit - (now - self._began)
        return f"at most {duration(rest)} left" if rest > 0 else ""

    def _show(self) -> None:
        with self._lock:
            if self._timer is None or self._live is not None:
                return
            self._live = Live(
                get_renderable=self._render,
                console=self._console,
                refresh_per_second=5,
                transient=True,
                redirect_stdout=False,
                redirect_stderr=False,
            )
            self._live.start()

    def _hide(self) -> None:
        if self._live is not None:
            self._live.stop()
            self._live = None

    def _render(self) -> RenderableType:
        grid = Table.grid(padding=(0, 1))
        text = Text(self.line(), no_wrap=True, overflow="ellipsis")
        if self._total:
            bar = ProgressBar(total=self._total, completed=self._done, width=WIDTH)
            grid.add_row(self._spinner, bar, text)
        else:
            grid.add_row(self._spinner, text)
        return grid


def duration(seconds: float) -> str:
    """A duration of seconds or minutes, for a person."""
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


def _can_move(console: Console) -> bool:
    """True on a terminal whose cursor moves; ``FORCE_COLOR`` does not make a pipe one."""
    return console.file.isatty() and console.is_terminal and not console.is_dumb_terminal


class VerificationProgress(Progress):
    """A listener for the stages of a verification."""

    def __init__(self, budget: Budget, timeout: float) -> None:
        """Set up.

        Args:
            budget: How far to explore.
            timeout: Seconds for model checking.
        """
        super().__init__("exploring the plan", limit=budget.seconds)
        self._states, self._timeout = budget.states, timeout

    def __call__(self, stage: str, count: int) -> None:
        """Take up a stage, or how far it is."""
        if stage == "exploring":
            self.update(f"exploring the plan: {count:,} states, at most {self._states:,}")
        else:
            self.update(f"checking {count} rules", limit=self._timeout)


class OptimizationProgress(Progress):
    """A listener for the events of an optimization that shows the latest one."""

    def __init__(
        self,
        steps: int | None = None,
        seconds: float | None = None,
        *,
        console: Console | None = None,
        delay: float | None = None,
    ) -> None:
        """Set up.

        Args:
            steps: How many steps it may take.
            seconds: How long it may take.
            console: Where to show progress; standard error by default.
            delay: Seconds until it shows; two by default.
        """
        super().__init__(
            "checking the rules", limit=seconds, console=console, delay=delay, early=True
        )
        self._steps = steps
        self._before: int | None = None

    def __call__(self, event: Event) -> None:
        """Show an event."""
        message = (event.message.splitlines() or [""])[0]
        if not event.step:
            self.update(detail=message)
            return
        limit = f" of at most {self._steps}" if self._steps else ""
        detail = "" if event.kind == "step" else f"{event.kind}: {message}"
        self.update(f"step {event.step}{limit}", detail=detail)
        if self._steps:
            # A run that is resumed starts behind the steps of the run before it.
            self._before = event.step if self._before is None else self._before
            done, total = event.step - self._before, self._steps - self._before + 1
            self.update(done=done, total=total)
