"""Time limits that a search can be asked to keep."""

from __future__ import annotations

import time
from collections.abc import Callable

__all__ = ["Clock", "OutOfTimeError"]


class OutOfTimeError(Exception):
    """A search had to stop before it knew the answer."""


class Clock:
    """Says when a search must stop.

    Args:
        seconds: From now on.
        stopped: Asked as well: true when nobody waits for the answer any more.
    """

    def __init__(self, seconds: float, stopped: Callable[[], bool] | None = None) -> None:
        self._deadline = time.monotonic() + seconds
        self._stopped = stopped

    @property
    def left(self) -> float:
        """Seconds that are left; 0 where there are none."""
        return max(0.0, self._deadline - time.monotonic())

    def check(self) -> None:
        """Do nothing while there is time.

        Raises:
            OutOfTimeError: There is none, or the answer is not wanted any more.
        """
        if not self.left or (self._stopped is not None and self._stopped()):
            raise OutOfTimeError
