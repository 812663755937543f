"""A worker process: takes jobs from a pipe, one at a time, and answers on another.

It ends, with everything that it has started, as soon as the pipe of jobs is closed: when the
program that started it ends in whatever way, nothing is left.
"""

from __future__ import annotations

import os
import queue
import signal
import threading
from multiprocessing.connection import Connection

from vaso.parallel.job import greeting, perform_packed

__all__ = ["main"]


def main(jobs_fd: int, answers_fd: int) -> None:
    """Serve until the pipe of jobs is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the program decides what Ctrl-C ends
    jobs: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    answers = Connection(answers_fd, readable=False)
    answers.send_bytes(greeting())
    threading.Thread(target=_listen, args=(jobs_fd, jobs), daemon=True).start()
    try:
        while True:
            answers.send_bytes(perform_packed(jobs.get()))
    except OSError:
        _leave()


def _listen(jobs_fd: int, jobs: queue.SimpleQueue[bytes]) -> None:
    incoming = Connection(jobs_fd, writable=False)
    try:
        while True:
            jobs.put(incoming.recv_bytes())
    except (EOFError, OSError):
        _leave()


def _leave() -> None:
    """End at once, with the processes of the group: what is under way is of no use to anybody."""
    os.killpg(0, signal.SIGKILL)
