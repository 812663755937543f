"""Measured values, and how they are taken."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import ParamSpec, TypeVar

__all__ = ["Point", "timed"]

P = ParamSpec("P")
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Point:
    """A measured time.

    Attributes:
        series: What was timed, such as ``NuSMV``.
        x: The size that was varied.
        seconds: Median wall time; None where it took longer than allowed.
        what: The workload in words.
        outcome: What came out, to show that everybody solved the same problem.
    """

    series: str
    x: float
    seconds: float | None
    what: str = ""
    outcome: str = ""


def timed(repeats: int, run: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> tuple[float, T]:
    """Call a function some times.

    Args:
        repeats: How often.
        run: The function.
        args: Its arguments.
        kwargs: Its further arguments.

    Returns:
        The median wall time in seconds, and what the function returned last.
    """
    times: list[float] = []
    for _ in range(max(1, repeats)):
        start = time.perf_counter()
        found = run(*args, **kwargs)
        times.append(time.perf_counter() - start)
    return statistics.median(times), found
