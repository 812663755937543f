"""Processor time of this process and of everything that it has started, on Linux."""

from __future__ import annotations

import os
from pathlib import Path

__all__ = ["cpu_seconds"]


def cpu_seconds() -> dict[int, float]:
    """Seconds of each process of the tree below this one; empty where the system does not tell."""
    times: dict[int, float] = {}
    children: dict[int, list[int]] = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rsplit(") ", 1)[1].split()
        except (OSError, IndexError):
            continue
        pid, parent = int(path.parent.name), int(fields[1])
        times[pid] = sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")
        children.setdefault(parent, []).append(pid)
    found, todo = {}, [os.getpid()] if times else []
    while todo:
        pid = todo.pop()
        found[pid] = times.get(pid, 0.0)
        todo += children.get(pid, [])
    return found
