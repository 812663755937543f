"""Keep what a framework prints and logs away from the user's terminal."""

from __future__ import annotations

import io
import logging
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO


class _ForThisThread(io.TextIOBase):
    """A stream that swallows what one thread writes and passes on what others write."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._thread = threading.get_ident()

    def write(self, text: str) -> int:
        """Swallow or pass on."""
        if threading.get_ident() == self._thread:
            return len(text)
        return self._stream.write(text)

    def flush(self) -> None:
        """Flush the stream behind."""
        self._stream.flush()

    def isatty(self) -> bool:
        """As the stream behind."""
        return self._stream.isatty()

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """As the stream behind."""
        return self._stream.encoding


@contextmanager
def quiet(logger: str) -> Iterator[None]:
    """Swallow what this thread prints, and what a logger and those below it log.

    A progress display that another thread draws goes on undisturbed.

    Args:
        logger: Name of the framework's logger.
    """
    log = logging.getLogger(logger)
    before, out = (log.propagate, log.level), sys.stdout
    silent = logging.NullHandler()
    log.propagate = False
    log.addHandler(silent)
    sys.stdout = _ForThisThread(out)
    try:
        yield
    finally:
        sys.stdout = out
        log.removeHandler(silent)
        log.propagate, log.level = before
