"""One processor core for a plan and its sandbox, which take turns.

Exploration waits while the sandbox's process works, and the other way round. On two cores each has
to wake the other's core from idle, which takes as long as the work itself, above all in virtual
machines. On one core they hand over at once. Cores are shared with others, though, so a core that
is busy is left again.

Linux only; elsewhere nothing happens.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["OneCore", "adopt", "client_threads"]

BUSY = 0.25
"""The share of its time for which exploration may wait for its core (0.15 without others)."""

WINDOW_S = 0.02
"""How often that share is looked at."""

_lock = threading.Lock()
_clients: dict[int, list[int]] = {}
_holder: list[OneCore] = []


@contextmanager
def client_threads() -> Iterator[None]:
    """Remember the threads that start meanwhile: they are the sandbox's client in this process."""
    before = set(_threads(os.getpid()))
    yield
    _clients.clear()
    _clients[os.getpid()] = [t for t in _threads(os.getpid()) if t not in before]


def adopt(worker: int) -> None:
    """Have a process of the sandbox keep to the core of who uses it.

    Args:
        worker: Its process identifier.
    """
    with _lock:
        for holder in _holder:
            if holder.thread == threading.get_native_id():
                holder.take(worker)
            else:  # somebody else explores at the same time: both need room
                holder.free()
                _allow(_threads(worker), holder.allowed)


class OneCore:
    """Keeps the calling thread and the sandbox on one core. Use as a context manager.

    It has no effect where another thread of this process explores at the same time, where the
    thread has been given a single core anyway, or where the system does not tell who waits.

    Attributes:
        thread: The system's identifier of the thread that entered.
        allowed: The cores that this thread may use.
    """

    def __init__(self) -> None:
        self.thread = 0
        self.allowed: set[int] = set()
        self._core: set[int] = set()
        self._workers: set[int] = set()
        self._looked = (0.0, 0.0)

    def __enter__(self) -> OneCore:
        clients = _clients.get(os.getpid())
        core, waited = _current_core(), _delay()
        if not clients or core is None or waited is None:
            return self
        with _lock:
            if _holder:
                _holder[0].free()
                return self
            self.thread = threading.get_native_id()
            self.allowed = os.sched_getaffinity(0)
            if len(self.allowed) > 1 and core in self.allowed:
                self._core = {core}
                _allow([self.thread, *clients], self._core)
                self._looked = (time.monotonic(), waited)
                _holder.append(self)
        return self

    def __exit__(self, *exc: object) -> None:
        with _lock:
            if self in _holder:
                self.free()
                _holder.remove(self)

    def take(self, worker: int) -> None:
        """Have a process of the sandbox run on this core too."""
        if self._core and worker not in self._workers:
            self._workers.add(worker)
            _allow(_threads(worker), self._core)

    def check(self) -> None:
        """Leave the core if others need it; to be called now and then."""
        if not self._core:
            return
        now, (then, before) = time.monotonic(), self._looked
        if now - then < WINDOW_S:
            return
        waited = _delay()
        if waited is None or waited - before > BUSY * (now - then):
            with _lock:
                self.free()
        else:
            self._looked = now, waited

    @contextmanager
    def left(self) -> Iterator[None]:
        """Leave the core for a while, for what starts threads or processes: they inherit it."""
        if self._core:
            _allow([self.thread], self.allowed)
        try:
            yield
        finally:
            with _lock:
                if self._core:
                    _allow([self.thread], self._core)

    def free(self) -> None:
        """Let everybody run where they may."""
        if self._core:
            self._core = set()
            mine = [self.thread, *_clients.get(os.getpid(), [])]
            _allow(
                [*mine, *(t for worker in self._workers for t in _threads(worker))], self.allowed
            )


def _threads(process: int) -> list[int]:
    """The threads of a process; none where the system does not tell."""
    try:
        return [int(name) for name in os.listdir(f"/proc/{process}/task")]
    except OSError:
        return []


def _allow(threads: Iterable[int], cores: set[int]) -> None:
    for thread in threads:
        try:
            os.sched_setaffinity(thread, cores)
        except OSError:
            continue  # it has ended


def _current_core() -> int | None:
    """The core that the calling thread runs on; None where the system does not tell."""
    if not hasattr(os, "sched_setaffinity"):
        return None
    try:
        return int(Path("/proc/thread-self/stat").read_text().rsplit(") ", 1)[1].split()[36])
    except (OSError, IndexError, ValueError):
        return None


def _delay() -> float | None:
    """Seconds for which the calling thread could have run and had no core; None if not told."""
    try:
        return int(Path("/proc/thread-self/schedstat").read_text().split()[1]) / 1e9
    except (OSError, IndexError, ValueError):
        return None
