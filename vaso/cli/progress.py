"""Progress of a long command: one changing line, on a terminal only."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape

if TYPE_CHECKING:
    from vaso.optimizers.events import Event

WIDEST = 60


class Progress:
    """A listener for the events of an optimization that shows the latest one.

    Where standard error is not a terminal it shows nothing; the event log has everything.
    """

    def __init__(self, console: Console) -> None:
        """Take the console to show progress on."""
        self._status = console.status("starting") if console.is_terminal else None

    def __enter__(self) -> Progress:
        """Start showing."""
        if self._status:
            self._status.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop showing, and clear the line."""
        if self._status:
            self._status.stop()

    def __call__(self, event: Event) -> None:
        """Show an event."""
        if self._status:
            message = (event.message.splitlines() or [""])[0][:WIDEST]
            step = f"step {event.step}, " if event.step else ""
            self._status.update(escape(f"{step}{event.seconds:.0f} s: {event.kind} {message}"))
