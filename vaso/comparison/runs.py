"""The runs of a comparison: one after the other, or several at a time in processes of their own.

Threads would not do: frameworks seed Python's global random numbers, and the runs must not depend
on one another. A process that crashes costs its run only.
"""

from __future__ import annotations

import json
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from vaso.comparison.rows import Row
from vaso.comparison.running import empty_row, execute
from vaso.comparison.setup import Job
from vaso.errors import OptimizerError, VasoError
from vaso.optimizers import Event, get_optimizer

Tell = Callable[[Job, Event], None]
GRACE = 30.0
"""Seconds that an interrupted process gets to end."""


def one_by_one(jobs: Sequence[Job], tell: Tell) -> Iterator[Row]:
    """Make runs one after the other; an interrupt ends the one under way and the rest."""
    warm: set[str] = set()
    for job in jobs:
        row = execute(job, partial(tell, job), cold=job.label not in warm)
        warm.add(job.label)
        yield row
        if row.interrupted:
            return


def in_processes(jobs: Sequence[Job], tell: Tell) -> Iterator[Row]:
    """Make runs in processes, as many at a time as the jobs say; rows come as they are ready.

    Raises:
        OptimizerError: What the runs need cannot be handed to another process.
    """
    waiting: queue.SimpleQueue[tuple[Job, bytes]] = queue.SimpleQueue()
    for job in jobs:
        waiting.put((job, _packed(job)))
    if jobs:
        yield from _Pool(waiting, tell).rows(min(jobs[0].workers, len(jobs)))


class _Pool:
    """Threads that each look after one process at a time."""

    def __init__(self, waiting: queue.SimpleQueue[tuple[Job, bytes]], tell: Tell) -> None:
        self._waiting, self._tell = waiting, tell
        self._ready: queue.SimpleQueue[Row | None] = queue.SimpleQueue()
        self._processes: set[subprocess.Popen[bytes]] = set()
        self._lock = threading.Lock()
        self._stopped = False

    def rows(self, workers: int) -> Iterator[Row]:
        """The rows as they are ready. After an interrupt those of the runs under way still come."""
        for _ in range(workers):
            threading.Thread(target=self._work, daemon=True).start()
        left = workers
        try:
            while left:
                try:
                    row = self._ready.get()
                except KeyboardInterrupt:
                    self._stop()
                    continue
                if row is not None:
                    yield row
                left -= row is None
        finally:  # whoever takes the rows may stop as well
            self._stop()

    def _stop(self) -> None:
        with self._lock:
            self._stopped = True
            for process in self._processes:
                with suppress(OSError):
                    process.send_signal(signal.SIGINT)
                killer = threading.Timer(GRACE, process.kill)
                killer.daemon = True
                killer.start()

    def _work(self) -> None:
        while not self._stopped:
            try:
                job, payload = self._waiting.get_nowait()
            except queue.Empty:
                break
            try:
                row = self._run(job, payload)
            except Exception as error:
                row = _without_result(job, f"{type(error).__name__}: {error}")
            if row is not None:
                self._ready.put(row)
        self._ready.put(None)

    def _run(self, job: Job, payload: bytes) -> Row | None:
        with tempfile.TemporaryFile() as complaints:
            process = self._start(complaints)
            if process is None:
                return None
            row = None
            with suppress(BrokenPipeError), process:
                try:
                    row = self._follow(process, job, payload)
                finally:
                    with self._lock:
                        self._processes.discard(process)
            if row is not None or self._stopped:
                return row
            complaints.seek(0)
            return _crashed(job, process.returncode, complaints.read())

    def _start(self, complaints: Any) -> subprocess.Popen[bytes] | None:
        paths = [str(Path(path).absolute()) for path in sys.path]
        code = f"import sys; sys.path[:] = {paths!r}\nimport vaso.comparison.worker as w; w.main()"
        with self._lock:
            if self._stopped:
                return None
            process = subprocess.Popen(
                [sys.executable, "-c", code],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=complaints,
                start_new_session=True,  # the terminal's interrupt must reach it once, from here
            )
            self._processes.add(process)
            return process

    def _follow(self, process: subprocess.Popen[bytes], job: Job, payload: bytes) -> Row | None:
        """Hand over the job, pass on events, and wait for the row."""
        assert process.stdin is not None and process.stdout is not None
        process.stdin.write(payload)
        process.stdin.flush()
        for line in process.stdout:
            message = json.loads(line)
            if "row" in message:
                return Row.model_validate(message["row"])
            self._tell(job, Event.model_validate(message["event"]))
        return None


def _packed(job: Job) -> bytes:
    """A job for the worker process: a line with its size, then the job."""
    import cloudpickle  # type: ignore[import-untyped]

    dspy = sys.modules.get("dspy")
    adapter = dspy.settings.adapter if dspy else None
    with suppress(VasoError):  # what is registered here is not registered there
        job = replace(job, optimizer=get_optimizer(job.optimizer))
    try:
        content: bytes = cloudpickle.dumps((job, adapter))
    except Exception as error:
        raise OptimizerError(
            f"the run '{job.label}' cannot be handed to another process: {error}",
            hint="with workers=1 all runs are made in this process",
        ) from error
    return f"{len(content)}\n".encode() + content


def _crashed(job: Job, code: int, complaints: bytes) -> Row:
    lines = complaints.decode("utf-8", "replace").strip().splitlines()
    last = f": {lines[-1]}" if lines else ""
    return _without_result(job, f"the process of the run ended with exit code {code}{last}")


def _without_result(job: Job, error: str) -> Row:
    return empty_row(job).model_copy(update={"error": error})
