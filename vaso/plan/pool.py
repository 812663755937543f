"""The processes of the sandbox."""

from __future__ import annotations

import atexit
import os
import threading

from pydantic_monty import Monty

from vaso.plan.affinity import client_threads

__all__ = ["pool"]

_lock = threading.Lock()
_pools: dict[int, Monty] = {}


def pool() -> Monty:
    """This process's pool of sandbox processes, started on first use, and again after a fork."""
    with _lock:
        found = _pools.get(os.getpid())
        if found is None:
            found = Monty(max_processes=16, request_timeout=30.0, checkout_timeout=60.0)
            with client_threads():
                found.__enter__()
            _pools.clear()
            _pools[os.getpid()] = found
            atexit.register(_shutdown, os.getpid())
        return found


def _shutdown(pid: int) -> None:
    found = _pools.pop(pid, None)
    if found is not None and pid == os.getpid():
        found.__exit__(None, None, None)
