"""Keep what a framework prints and logs away from the user's terminal."""

from __future__ import annotations

import io
import logging
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

_silent = threading.local()
"""Per thread: how many ``quiet`` blocks it is in."""


@contextmanager
def quiet(logger: str) -> Iterator[None]:
    """Swallow what this thread prints, and what a logger and those below it log.

    A progress display that another thread draws goes on undisturbed. Blocks may be nested, and
    several threads may be in one at the same time.

    Args:
        logger: Name of the framework's logger.
    """
    with _streams, _silenced_logger(logger), _depth(_depth_here() + 1):
        yield


@contextmanager
def aloud() -> Iterator[None]:
    """Inside ``quiet``: let this thread print, for what is not the framework's."""
    with _depth(0):
        yield


@contextmanager
def _depth(value: int) -> Iterator[None]:
    before = _depth_here()
    _silent.depth = value
    try:
        yield
    finally:
        _silent.depth = before


def _depth_here() -> int:
    return getattr(_silent, "depth", 0)


def _is_silent() -> bool:
    """True for a silent thread, and for the one in which tqdm redraws the bars of all others."""
    return _depth_here() > 0 or type(threading.current_thread()).__name__ == "TMonitor"


class _Muted(io.TextIOBase):
    """A stream that swallows what silent threads write and passes on what others write."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        """Swallow or pass on."""
        return len(text) if _is_silent() else self.stream.write(text)

    def flush(self) -> None:
        """Flush the stream behind."""
        self.stream.flush()

    def fileno(self) -> int:
        """As the stream behind."""
        return self.stream.fileno()

    def isatty(self) -> bool:
        """As the stream behind."""
        return self.stream.isatty()

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """As the stream behind."""
        return self.stream.encoding


class _Shared:
    """Something of the whole process that is changed while at least one thread needs it."""

    def __init__(self) -> None:
        self._users, self._lock = 0, threading.Lock()

    def __enter__(self) -> None:
        with self._lock:
            self._users += 1
            if self._users == 1:
                self.change()

    def __exit__(self, *error: object) -> None:
        with self._lock:
            self._users -= 1
            if self._users == 0:
                self.restore()

    def change(self) -> None:
        """For the first user."""

    def restore(self) -> None:
        """After the last user."""


class _Streams(_Shared):
    """``sys.stdout`` and ``sys.stderr``."""

    def change(self) -> None:
        """Put the muted streams in their place."""
        there = {n: getattr(sys, n) for n in ("stdout", "stderr")}
        self._muted = {n: _Muted(stream) for n, stream in there.items() if stream is not None}
        for name, stream in self._muted.items():
            setattr(sys, name, stream)

    def restore(self) -> None:
        """Put them back, unless somebody has put others there meanwhile."""
        for name, stream in self._muted.items():
            if getattr(sys, name) is stream:
                setattr(sys, name, stream.stream)


class _Logger(_Shared):
    """A logger and those below it."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self._log, self._silent = logging.getLogger(name), logging.NullHandler()

    def change(self) -> None:
        """Keep records from the handlers above."""
        self._before = self._log.propagate, self._log.level
        self._log.propagate = False
        self._log.addHandler(self._silent)

    def restore(self) -> None:
        """As before."""
        self._log.removeHandler(self._silent)
        self._log.propagate, self._log.level = self._before


_streams = _Streams()
_loggers: dict[str, _Logger] = {}
_loggers_lock = threading.Lock()


def _silenced_logger(name: str) -> _Logger:
    with _loggers_lock:
        return _loggers.setdefault(name, _Logger(name))
