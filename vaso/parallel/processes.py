"""Workers as processes of this machine."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import IO

from vaso.parallel.crew import Event, Lost, Reply

__all__ = ["ProcessCrew", "usable_cores"]


def usable_cores() -> int:
    """Processor cores that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


@dataclass(eq=False, slots=True)
class ProcessWorker:
    """A process, the pipes to it, and what it complains of."""

    process: subprocess.Popen[bytes]
    jobs: Connection
    answers: Connection
    complaints: IO[bytes]


class ProcessCrew:
    """Processes that each keep a sandbox and a model checker.

    They are started as programs of their own, not forked: a program with threads or a GPU may use
    them, and a script needs no ``if __name__ == "__main__"``.

    Args:
        workers: How many; by default one for each core.
    """

    def __init__(self, workers: int | None = None) -> None:
        self.workers = workers or usable_cores()
        self._alive: set[ProcessWorker] = set()

    def start(self) -> ProcessWorker:
        """Start a process."""
        jobs_read, jobs_write = os.pipe()
        answers_read, answers_write = os.pipe()
        paths = [str(Path(path).absolute()) for path in sys.path]
        code = (
            f"import sys; sys.path[:] = {paths!r}\n"
            f"from vaso.parallel.worker import main; main({jobs_read}, {answers_write})"
        )
        complaints = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the worker
        try:
            process = subprocess.Popen(
                [sys.executable, "-c", code],
                stdin=subprocess.DEVNULL,
                stdout=complaints,
                stderr=complaints,
                pass_fds=(jobs_read, answers_write),
                start_new_session=True,  # the terminal's Ctrl-C is for the program only
            )
        finally:
            os.close(jobs_read)
            os.close(answers_write)
        worker = ProcessWorker(
            process,
            Connection(jobs_write, readable=False),
            Connection(answers_read, writable=False),
            complaints,
        )
        self._alive.add(worker)
        return worker

    def send(self, worker: ProcessWorker, job: bytes) -> None:
        """Give a job to a process. That it is gone shows when it is waited for."""
        with contextlib.suppress(OSError):
            worker.jobs.send_bytes(job)

    def wait(
        self, workers: Sequence[ProcessWorker], timeout: float
    ) -> list[tuple[ProcessWorker, Event]]:
        """Replies of processes, and those that are gone."""
        places = {worker.answers: worker for worker in workers}
        ready = [places[found] for found in wait(list(places), timeout) if found in places]
        return [(worker, self._event(worker)) for worker in ready]

    def _event(self, worker: ProcessWorker) -> Event:
        try:
            return Reply(worker.answers.recv_bytes())
        except (EOFError, OSError):
            return Lost(self._obituary(worker))

    def _obituary(self, worker: ProcessWorker) -> str:
        with contextlib.suppress(subprocess.TimeoutExpired):
            worker.process.wait(1.0)
        code = worker.process.poll()
        if code is None:
            how = "it closed its pipe"
        elif code < 0:
            how = f"it was ended by {signal.Signals(-code).name}"
        else:
            how = f"it ended with exit code {code}"
        with contextlib.suppress(OSError, ValueError):
            worker.complaints.seek(0)
            lines = worker.complaints.read().decode("utf-8", "replace").strip().splitlines()
            if lines and code != -signal.SIGKILL:
                how += f": {lines[-1]}"
        return how

    def kill(self, worker: ProcessWorker) -> None:
        """End a process and its group."""
        self._alive.discard(worker)
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(worker.process.pid, signal.SIGKILL)
        worker.process.wait()
        for end in (worker.jobs, worker.answers, worker.complaints):
            with contextlib.suppress(OSError):
                end.close()

    def close(self) -> None:
        """End every process."""
        for worker in list(self._alive):
            self.kill(worker)
