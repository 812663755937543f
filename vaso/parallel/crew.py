"""What a place to verify plans in must offer: workers that can be started, asked and killed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

__all__ = ["Crew", "Event", "Lost", "Reply"]


@dataclass(frozen=True, slots=True)
class Reply:
    """What a worker says: a greeting when it has started, then an answer to each job."""

    content: bytes


@dataclass(frozen=True, slots=True)
class Lost:
    """A worker is gone.

    Attributes:
        reason: How it ended.
    """

    reason: str


Event: TypeAlias = Reply | Lost


class Crew(Protocol):
    """Starts workers, hands them jobs, and tells what happens to them.

    A worker is whatever the crew says it is. It works at one job at a time; a job and an answer are
    bytes (see :mod:`vaso.parallel.job`). All methods are called from one thread.
    """

    workers: int
    """How many workers are wanted."""

    def start(self) -> Any:
        """Start a worker. Its first reply is a greeting.

        Raises:
            VasoError: No worker can be started here.
        """
        ...

    def send(self, worker: Any, job: bytes) -> None:
        """Give a job to a worker that has answered everything before."""
        ...

    def wait(self, workers: Sequence[Any], timeout: float) -> list[tuple[Any, Event]]:
        """What happened to workers that were started or given a job; waits for at most so long."""
        ...

    def kill(self, worker: Any) -> None:
        """End a worker, whatever it does, with everything that it has started."""
        ...

    def close(self) -> None:
        """Kill every worker that is left."""
        ...
