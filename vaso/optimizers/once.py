"""A memo that several threads share: whatever they ask for at the same time is made once."""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

T = TypeVar("T")


class Once(Generic[T]):
    """Values by key, each made on first use. What raises is not kept, and is tried again."""

    def __init__(self) -> None:
        self.values: dict[Hashable, T] = {}
        self._locks: dict[Hashable, threading.Lock] = {}
        self._lock = threading.Lock()

    def __contains__(self, key: Hashable) -> bool:
        return key in self.values

    def get(self, key: Hashable, make: Callable[[], T]) -> T:
        """The value of a key.

        Args:
            key: The key.
            make: Makes the value. It is called once, however many threads ask meanwhile.
        """
        if key in self.values:
            return self.values[key]
        with self._lock:
            lock = self._locks.setdefault(key, threading.Lock())
        with lock:
            if key not in self.values:
                self.values[key] = make()
        return self.values[key]
