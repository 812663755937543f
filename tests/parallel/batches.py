"""Plans for batches, and the processes that verify them."""

import os
import time
from pathlib import Path

GOOD = """\
while True:
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
"""
FAULTY = "while True:\n    forward()\n"
BROKEN = "while True\n    forward()\n"
SLOW = """\
seen = []
while True:
    seen.append(len(seen))
    if sum(seen) % 1001 == 7:
        forward()
    stop()
"""
"""Every state is new, so exploration goes on to its bound."""


def descendants(root: int | None = None) -> dict[int, str]:
    """Every process below one, with its command line."""
    parents: dict[int, list[int]] = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            pid, rest = path.read_text().split(" (", 1)
            state, parent = rest.rsplit(") ", 1)[1].split()[:2]
        except (OSError, ValueError):
            continue
        if state != "Z":
            parents.setdefault(int(parent), []).append(int(pid))
    found, todo = [], [root or os.getpid()]
    while todo:
        children = parents.get(todo.pop(), [])
        found += children
        todo += children
    return {pid: _command(pid) for pid in found}


def _command(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    except OSError:
        return ""


def workers() -> list[int]:
    """The worker processes of batches of this program."""
    return [pid for pid, command in descendants().items() if "vaso.parallel.worker" in command]


def eventually(condition, seconds: float = 10.0) -> bool:
    """Wait for a condition."""
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.02)
    return True
