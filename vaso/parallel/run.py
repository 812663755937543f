"""One pass over a batch: what the memo knows, then what a crew finds out."""

from __future__ import annotations

import queue
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing
from typing import Any

from vaso.memo.sources import code_digest
from vaso.parallel.crew import Crew
from vaso.parallel.entries import Entry
from vaso.parallel.job import Job, Outcome, perform
from vaso.parallel.results import PlanResult
from vaso.parallel.scheduler import Done, Scheduler
from vaso.verdict import VerificationResult

__all__ = ["Run"]

_POLL = 0.1


class Run:
    """One pass over a batch: the memo first, then the crew."""

    def __init__(
        self,
        entries: Sequence[Entry],
        crew: Crew | None,
        timeout: float | None,
        cancelled: Callable[[], bool],
        on_result: Callable[[PlanResult], None] | None,
    ) -> None:
        self.entries, self.crew, self.timeout = entries, crew, timeout
        self.cancelled, self.on_result = cancelled, on_result

    def results(self) -> Generator[PlanResult, None, None]:
        """The results as they come."""
        with closing(self._found()) as found:
            for result in found:
                if self.on_result:
                    self.on_result(result)
                yield result

    def _found(self) -> Generator[PlanResult, None, None]:
        left: dict[Any, list[int]] = {}
        for index, entry in enumerate(self.entries):
            if self.cancelled():
                return
            result = self._known(entry)
            if result is not None:
                yield PlanResult(index, result)
            else:
                left.setdefault(_identity(entry, index), []).append(index)
        groups = list(left.values())
        yield from self._serially(groups) if self.crew is None else self._by_crew(groups)

    def _known(self, entry: Entry) -> VerificationResult | None:
        if entry.job is None:
            return entry.undecided(entry.problem, kind="input")
        return entry.recall.find() if entry.recall else None

    def _serially(self, groups: Sequence[Sequence[int]]) -> Iterator[PlanResult]:
        for indices in groups:
            if self.cancelled():
                return
            yield from self._told(indices, perform(self._job(indices)), code_digest())

    def _by_crew(self, groups: Sequence[Sequence[int]]) -> Iterator[PlanResult]:
        if not groups:
            return
        assert self.crew is not None
        jobs = [(number, self._job(indices)) for number, indices in enumerate(groups)]
        scheduler = Scheduler(self.crew, jobs, self.timeout)
        scheduler.start()
        try:
            while (done := self._next(scheduler)) is not None:
                yield from self._told(groups[done.number], done.outcome, done.code)
        finally:
            scheduler.stop()

    def _job(self, indices: Sequence[int]) -> Job:
        job = self.entries[indices[0]].job
        assert job is not None
        return job

    def _next(self, scheduler: Scheduler) -> Done | None:
        """What is over next; None at the end."""
        while not self.cancelled():
            try:
                found = scheduler.ready.get(timeout=_POLL)
            except queue.Empty:
                continue
            if isinstance(found, BaseException):
                raise found
            return found
        return None

    def _told(
        self, indices: Sequence[int], outcome: Outcome, code: str | None
    ) -> Iterator[PlanResult]:
        """The result of a job for every plan that it stands for."""
        first = self.entries[indices[0]]
        if first.recall and outcome.encoded is not None and code == code_digest():
            first.recall.keep_encoded(outcome.encoded, is_named=outcome.is_named)
        result = outcome.result
        if result is None:
            result = first.undecided(outcome.error, kind=outcome.kind)
        for index in indices:
            yield PlanResult(index, result)


def _identity(entry: Entry, index: int) -> Any:
    """Equal for plans that get the same result for sure."""
    if entry.recall is None or entry.recall.key is None:
        return index
    return entry.recall.key, entry.recall.names
