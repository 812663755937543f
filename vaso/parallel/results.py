"""The results of a batch."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

from vaso.parallel.entries import Entry
from vaso.verdict import Verdict, VerificationResult

__all__ = ["Batch", "PlanResult"]

CANCELLED = "cancelled before the plan was decided"


@dataclass(frozen=True, slots=True)
class PlanResult:
    """The result of one plan of a batch; unpacks into both. Truthy only if every rule passes.

    Attributes:
        index: The plan's place in the batch, from 0.
        result: Its result. It has no automaton (``system``); :func:`vaso.compile_plan` makes it.
    """

    index: int
    result: VerificationResult

    def __bool__(self) -> bool:
        """True only when every rule passes."""
        return bool(self.result)

    def __iter__(self) -> Iterator[Any]:
        """The index, then the result."""
        return iter((self.index, self.result))

    @property
    def verdict(self) -> Verdict:
        """The verdict on the plan."""
        return self.result.verdict


class Batch(Iterator[PlanResult]):
    """The results of a batch, as they come; in the plans' order with :meth:`collect`.

    Closing it, leaving its ``with`` block, or an interrupt gives up what is not done yet and ends
    every worker.

    Attributes:
        total: Number of plans.
        results: The results so far, by the plan's place.
    """

    def __init__(
        self, entries: Sequence[Entry], results: Generator[PlanResult, None, None]
    ) -> None:
        self.total = len(entries)
        self.results: dict[int, VerificationResult] = {}
        self._entries, self._coming = entries, results

    def __iter__(self) -> Batch:
        return self

    def __next__(self) -> PlanResult:
        found = next(self._coming)
        self.results[found.index] = found.result
        return found

    def __len__(self) -> int:
        """Number of plans."""
        return self.total

    def __enter__(self) -> Batch:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Give up what is not done yet; every worker is gone when this returns."""
        self._coming.close()

    def collect(self) -> list[VerificationResult]:
        """Wait for the results that are still to come; all of them in the order of the plans.

        A plan that was given up is UNKNOWN, and says so.
        """
        for _ in self:
            pass
        return [
            self.results[i] if i in self.results else entry.undecided(CANCELLED)
            for i, entry in enumerate(self._entries)
        ]
