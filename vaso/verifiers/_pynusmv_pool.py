"""Worker processes of the PyNuSMV engine: started on demand, shared by the whole process."""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import select
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from vaso.errors import VerifierError

_SCRIPT = Path(__file__).with_name("_pynusmv_worker.py")
_START_SECONDS = 60.0
_GRACE_SECONDS = 1.0  # for a worker to report its own time-out before it is killed


class WorkerGoneError(Exception):
    """A worker that died or no longer answers."""


class Worker:
    """One worker process and the two pipes to it."""

    def __init__(self) -> None:
        request_read, self._requests = os.pipe()
        self._responses, response_write = os.pipe()
        self._rest = b""
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the worker
        command = [sys.executable, "-P", str(_SCRIPT), str(request_read), str(response_write)]
        try:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=self._errors,
                pass_fds=(request_read, response_write),
                start_new_session=True,
            )
        finally:
            os.close(request_read)
            os.close(response_write)
        self._await_ready()

    @property
    def pid(self) -> int:
        """Process id of the worker."""
        return self._process.pid

    def _await_ready(self) -> None:
        try:
            hello = self._receive(time.monotonic() + _START_SECONDS)
        except WorkerGoneError as error:
            self.close()
            raise VerifierError(f"the PyNuSMV worker does not start: {error}") from error
        if "fatal" in hello:
            self.close()
            raise VerifierError(
                f"PyNuSMV cannot be loaded: {hello['fatal']}",
                hint="run `make setup`, which builds PyNuSMV, or use the NuSMV binary",
            )

    def run(self, request: dict[str, Any]) -> Iterator[dict[str, Any]]:
        """Send a request and yield its messages, the last of which is the ``end``.

        Raises:
            WorkerGoneError: The worker died, or did not keep the request's deadline.
        """
        deadline = time.monotonic() + request["deadline"] + _GRACE_SECONDS
        self._send(request)
        while True:
            message = self._receive(deadline)
            yield message
            if "end" in message:
                return

    def _send(self, request: dict[str, Any]) -> None:
        data = memoryview(json.dumps(request).encode() + b"\n")
        try:
            while data:
                data = data[os.write(self._requests, data) :]
        except OSError as error:
            raise WorkerGoneError(self._obituary()) from error

    def _receive(self, deadline: float) -> dict[str, Any]:
        poll = select.poll()
        poll.register(self._responses, select.POLLIN)
        while b"\n" not in self._rest:
            if not poll.poll(max(0.0, deadline - time.monotonic()) * 1000):
                raise WorkerGoneError("the worker does not answer")
            chunk = os.read(self._responses, 1 << 20)
            if not chunk:
                raise WorkerGoneError(self._obituary())
            self._rest += chunk
        line, self._rest = self._rest.split(b"\n", 1)
        message: dict[str, Any] = json.loads(line)
        return message

    def _obituary(self) -> str:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_GRACE_SECONDS)
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        code = self._process.returncode
        return "; ".join([f"the worker ended with code {code}", *lines[-1:]])

    def close(self) -> None:
        """End the process, with everything it started."""
        self.abandon()
        # It notices the closed pipe, kills its child and leaves.
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_GRACE_SECONDS)
        if self._process.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._process.pid, 9)
            self._process.wait()

    def abandon(self) -> None:
        """Close this process's ends of the pipes (all that a forked copy may do)."""
        for fd in (self._requests, self._responses):
            with contextlib.suppress(OSError):
                os.close(fd)
        self._errors.close()


class WorkerPool:
    """At most ``capacity`` workers, each serving one request at a time."""

    def __init__(self) -> None:
        self.capacity = 1
        self._idle: list[Worker] = []
        self._all: list[Worker] = []
        self._change = threading.Condition()
        self._reserved = 0

    def grow(self, capacity: int) -> None:
        """Allow at least that many workers."""
        with self._change:
            self.capacity = max(self.capacity, capacity)
            self._change.notify_all()

    @contextlib.contextmanager
    def worker(self, timeout: float) -> Iterator[Worker | None]:
        """An idle worker, or a new one; None where none is free in time.

        A worker that the body does not finish with (an exception leaves it) is ended.
        """
        worker = self._acquire(timeout)
        try:
            yield worker
        except BaseException:
            if worker:
                self._release(worker, keep=False)
            raise
        if worker:
            self._release(worker, keep=True)

    def _acquire(self, timeout: float) -> Worker | None:
        with self._change:
            free = self._change.wait_for(
                lambda: self._idle or len(self._all) + self._reserved < self.capacity, timeout
            )
            if not free:
                return None
            if self._idle:
                return self._idle.pop()
            self._reserved += 1
        worker = None
        try:
            worker = Worker()
        finally:
            with self._change:
                self._reserved -= 1
                if worker:
                    self._all.append(worker)
                self._change.notify_all()
        return worker

    def _release(self, worker: Worker, *, keep: bool) -> None:
        if not keep:
            worker.close()
        with self._change:
            if keep:
                self._idle.append(worker)
            else:
                self._all.remove(worker)
            self._change.notify_all()

    def close(self) -> None:
        """End the workers that are idle."""
        with self._change:
            idle, self._idle = self._idle, []
            self._all = [worker for worker in self._all if worker not in idle]
        for worker in idle:
            worker.close()

    def abandon(self) -> None:
        """Forget all workers, in a forked copy of the process that owns them."""
        for worker in self._all:
            worker.abandon()


pool = WorkerPool()


def _forget_after_fork() -> None:
    global pool
    pool.abandon()
    capacity, pool = pool.capacity, WorkerPool()
    pool.capacity = capacity


os.register_at_fork(after_in_child=_forget_after_fork)
atexit.register(lambda: pool.close())
