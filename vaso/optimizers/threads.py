"""Do the same with several things at the same time."""

from __future__ import annotations

import contextvars
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

S = TypeVar("S")
T = TypeVar("T")
THREADS = 4


def in_threads(work: Callable[[S], T], things: Iterable[S], threads: int = THREADS) -> list[T]:
    """Results in the order of the things.

    Each is worked on in a copy of the caller's context, so that dspy's settings reach it. What
    one of them raises is raised when all are done; the first in order, if there are several.

    Args:
        work: What to do.
        things: With what.
        threads: How many at the same time.
    """
    listed = list(things)
    if len(listed) == 1:
        return [work(listed[0])]
    with ThreadPoolExecutor(threads) as pool:
        doing = [pool.submit(contextvars.copy_context().run, work, thing) for thing in listed]
        return [one.result() for one in doing]
