"""The default SMV engine: NuSMV inside worker processes, through PyNuSMV."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from vaso.verifiers import _pynusmv_pool
from vaso.verifiers.engine import (
    SMVAnswer,
    SMVStep,
    SMVTrace,
    one_line,
    spec_problem,
)

_FIRST_TRY = 0.25  # share of the time left that a formula gets while others are waiting
_TIME_OUT = "time-out"


class PyNuSMVEngine:
    """Decides formulas with PyNuSMV, one worker process per request at a time.

    Workers are shared by all engines of the process and start with the first check. A model is
    loaded once per call. When a formula hangs or crashes NuSMV, the others are decided by a fresh
    NuSMV; a formula that hangs gets a second try with the time that the others leave.

    Args:
        workers: How many checks may run at the same time, when several threads ask.
        memory_mb: Address space of one check. Beyond it the check ends undecided.
    """

    name = "pynusmv"

    def __init__(self, workers: int = 1, memory_mb: int = 4096) -> None:
        self.workers = workers
        self.memory_mb = memory_mb

    def check(
        self, model: str, specs: Sequence[str], *, timeout: float = 60.0, traces: bool = True
    ) -> list[SMVAnswer]:
        """Decide formulas on one model; see :class:`~vaso.verifiers.engine.SMVEngine`.

        Raises:
            VerifierError: PyNuSMV is not installed or does not start.
        """
        if not specs:
            return []
        _pynusmv_pool.pool.grow(self.workers)
        job = _Job(model, specs, time.monotonic() + timeout, traces, self.memory_mb)
        job.run()
        return job.answers()


class _Job:
    """One call of ``check``: rounds with a worker until every formula has its answer."""

    def __init__(
        self, model: str, specs: Sequence[str], deadline: float, traces: bool, memory_mb: int
    ) -> None:
        self.model, self.deadline = model, deadline
        self.traces, self.memory_mb = traces, memory_mb
        self.specs = [one_line(spec) for spec in specs]
        self.known: dict[int, SMVAnswer] = {}
        self.waiting: deque[int] = deque()
        self.hung: deque[int] = deque()  # second try, when nothing else is waiting
        for number, spec in enumerate(self.specs):
            problem = spec_problem(spec)
            if problem:
                self.known[number] = SMVAnswer(None, 0.0, reason=problem)
            else:
                self.waiting.append(number)

    @property
    def left(self) -> float:
        return self.deadline - time.monotonic()

    def answers(self) -> list[SMVAnswer]:
        late = SMVAnswer(None, 0.0, reason=_TIME_OUT)
        return [self.known.get(number, late) for number in range(len(self.specs))]

    def run(self) -> None:
        while (self.waiting or self.hung) and self.left > 0:
            second_try = not self.waiting
            queue = self.hung if second_try else self.waiting
            others = len(queue) - 1 if second_try else len(queue) - 1 + len(self.hung)
            share = 1 / (others + 1) if second_try else _FIRST_TRY if others else 1.0
            _Round(self, queue, share, last_try=second_try or not others).run()

    def decide_all(self, reason: str) -> None:
        """Give every open formula the same undecided answer."""
        for queue in (self.waiting, self.hung):
            for number in queue:
                self.known[number] = SMVAnswer(None, 0.0, reason=reason)
            queue.clear()


class _Round:
    """One request: the open formulas, up to the first that hangs, crashes or is bad."""

    def __init__(self, job: _Job, queue: deque[int], share: float, last_try: bool) -> None:
        self.job, self.queue, self.last_try = job, queue, last_try
        self.slice = max(0.05, job.left * share)
        self.loaded = self.stopped = False
        self.tracing: int | None = None  # the formula whose trace is being computed
        self.started = time.monotonic()

    def run(self) -> None:
        try:
            with _pynusmv_pool.pool.worker(self.job.left) as worker:
                if worker is None:
                    self.job.decide_all("no worker was free in time")
                    return
                for message in worker.run(self._request()):
                    self._take(message)
        except _pynusmv_pool.WorkerGoneError as error:
            self._stop(f"NuSMV's worker was lost: {error}")

    def _request(self) -> dict[str, Any]:
        return {
            "model": self.job.model,
            "specs": [(number, self.job.specs[number]) for number in self.queue],
            "traces": self.job.traces,
            "deadline": self.job.left,
            "slice": self.slice,
            "memory_mb": self.job.memory_mb,
        }

    def _take(self, message: dict[str, Any]) -> None:
        if "loaded" in message:
            self.loaded, self.started = True, time.monotonic()
        elif "invalid" in message:
            self.job.decide_all(message["invalid"])
        elif "spec" in message:
            self._take_verdict(message["spec"], message["holds"], message["seconds"])
        elif "trace" in message:
            self._amend(message["trace"], trace=_trace(message))
        elif "no_trace" in message:
            self._amend(message["no_trace"], reason=message["reason"])
        elif "error" in message:
            self._stop(message["error"])
        elif message["end"] == "timeout":
            self._time_out()
        elif message["end"] == "crash" or (self.queue and not self.stopped):
            self._stop(message["detail"] or "NuSMV ended early")

    def _take_verdict(self, number: int, holds: bool, seconds: float) -> None:
        self.job.known[number] = SMVAnswer(holds, seconds)
        self.queue.remove(number)
        self.tracing = number if self.job.traces and not holds else None
        self.started = time.monotonic()

    def _amend(self, number: int, *, trace: SMVTrace | None = None, reason: str = "") -> None:
        self.job.known[number] = replace(self.job.known[number], trace=trace, reason=reason)
        self.tracing = None

    def _stop(self, reason: str) -> None:
        """The formula in progress is undecided for good; without a model, all of them are."""
        self.stopped = True
        if not self.loaded:
            self.job.decide_all(reason)
        elif self.tracing is not None:
            self._amend(self.tracing, reason=f"no trace: {reason}")
        elif self.queue:
            seconds = time.monotonic() - self.started
            self.job.known[self.queue.popleft()] = SMVAnswer(None, seconds, reason=reason)

    def _time_out(self) -> None:
        if not self.loaded:
            self.job.decide_all("time-out while loading the model")
        elif self.queue and self.tracing is None and not self.last_try:
            self.job.hung.append(self.queue.popleft())
        else:
            self._stop(_TIME_OUT)


def _trace(message: dict[str, Any]) -> SMVTrace:
    steps = (SMVStep(dict(zip(message["names"], row, strict=True))) for row in message["rows"])
    return SMVTrace(tuple(steps), message["loop"])
