"""Keeps the workers of a crew busy, kills those that are late, and replaces those that are lost."""

from __future__ import annotations

import queue
import threading
import time
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from vaso.errors import VerifierError
from vaso.parallel.crew import Crew, Event, Lost
from vaso.parallel.job import Job, Outcome, code_of, pack, unpack

__all__ = ["Done", "Scheduler"]

ATTEMPTS = 2
START_SECONDS = 300.0
"""For a worker to start; imports are slow on a loaded machine, and a cluster may have to grow."""
FALSE_STARTS = 3
"""So many workers in a row that are lost before they have said anything end the batch."""
MOST_JOBS = 500
"""After so many jobs a worker is replaced, whatever it may have leaked."""
_PATIENCE = 0.1


@dataclass(slots=True)
class _Task:
    """A job that is waiting or under way."""

    number: int
    job: Job
    attempts: int = 0


@dataclass(frozen=True, slots=True)
class Done:
    """A job that is over.

    Attributes:
        number: Its place in the batch.
        outcome: What came of it.
        code: Digest of the code that the worker runs.
    """

    number: int
    outcome: Outcome
    code: str | None = None


@dataclass(eq=False, slots=True)
class _Seat:
    """A worker with what it is doing."""

    worker: Any
    deadline: float
    task: _Task | None = None
    is_started: bool = False
    code: str | None = None
    jobs: int = 0


class Scheduler(threading.Thread):
    """Has the jobs of a batch done by a crew.

    A job whose worker is lost is given to a fresh worker once more; a job that takes too long is
    ended with its worker. Neither touches another job.

    Args:
        crew: The workers.
        jobs: Place in the batch of each job, and the job.
        timeout: Seconds for a job; its worker is killed then. None waits for ever.

    Attributes:
        ready: What is over, as :class:`Done`; an exception that ends everything; None at the end.
    """

    def __init__(self, crew: Crew, jobs: Iterable[tuple[int, Job]], timeout: float | None):
        super().__init__(name="vaso-batch", daemon=True)
        self.ready: queue.SimpleQueue[Done | BaseException | None] = queue.SimpleQueue()
        self._crew, self._timeout = crew, timeout
        self._waiting = deque(_Task(number, job) for number, job in jobs)
        self._seats: list[_Seat] = []
        self._stopped = threading.Event()
        self._false_starts = 0

    def stop(self) -> None:
        """Give up what is under way and what is waiting; return when every worker is gone."""
        self._stopped.set()
        self.join()

    def run(self) -> None:
        """Work until everything is done or given up."""
        try:
            while not self._stopped.is_set() and (self._waiting or self._busy()):
                self._fill()
                self._listen()
                self._expire()
        except BaseException as error:
            self.ready.put(error)
        finally:
            self._crew.close()
            self.ready.put(None)

    def _busy(self) -> int:
        return sum(seat.task is not None for seat in self._seats)

    # --- handing out ---------------------------------------------------------------------------

    def _fill(self) -> None:
        wanted = min(self._crew.workers, len(self._waiting) + self._busy())
        while len(self._seats) < wanted:
            deadline = time.monotonic() + START_SECONDS
            self._seats.append(_Seat(self._crew.start(), deadline))
        for seat in self._seats:
            if seat.is_started and seat.task is None and self._waiting:
                self._give(seat, self._waiting.popleft())

    def _give(self, seat: _Seat, task: _Task) -> None:
        task.attempts += 1
        seat.task, seat.jobs = task, seat.jobs + 1
        limit = float("inf") if self._timeout is None else self._timeout
        seat.deadline = time.monotonic() + limit
        self._crew.send(seat.worker, pack(task.job))

    # --- what comes back -----------------------------------------------------------------------

    def _listen(self) -> None:
        active = [s for s in self._seats if s.task is not None or not s.is_started]
        nearest = min((s.deadline for s in active), default=0.0)
        patience = max(0.0, min(_PATIENCE, nearest - time.monotonic()))
        by_worker = {id(s.worker): s for s in active}
        for worker, event in self._crew.wait([s.worker for s in active], patience):
            self._take(by_worker[id(worker)], event)

    def _take(self, seat: _Seat, event: Event) -> None:
        if isinstance(event, Lost):
            self._mourn(seat, event.reason)
        elif not seat.is_started:
            seat.is_started, seat.deadline = True, float("inf")
            self._false_starts = 0
            seat.code = code_of(event.content)
        elif seat.task is not None:
            self._finish(seat.task, unpack(event.content), seat.code)
            seat.task, seat.deadline = None, float("inf")
            if seat.jobs >= MOST_JOBS:
                self._dismiss(seat)

    def _finish(self, task: _Task, outcome: Outcome, code: str | None = None) -> None:
        self.ready.put(Done(task.number, outcome, code))

    def _mourn(self, seat: _Seat, reason: str) -> None:
        self._dismiss(seat)
        if not seat.is_started:
            self._false_starts += 1
            if self._false_starts >= FALSE_STARTS:
                raise VerifierError(f"a worker does not start: {reason}")
        task = seat.task
        if task is None:
            return
        if task.attempts < ATTEMPTS:
            self._waiting.appendleft(task)
        else:
            text = f"two workers were lost over this plan; the last time, {reason}"
            self._finish(task, Outcome(error=text))

    def _expire(self) -> None:
        now = time.monotonic()
        for seat in [s for s in self._seats if now > s.deadline]:
            self._dismiss(seat)
            if seat.task is None:
                raise VerifierError(f"a worker does not start within {START_SECONDS:g} s")
            text = f"time-out: the plan was not decided in {self._timeout:g} s"
            self._finish(seat.task, Outcome(error=text))

    def _dismiss(self, seat: _Seat) -> None:
        self._seats.remove(seat)
        self._crew.kill(seat.worker)
