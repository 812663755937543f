"""How many physical cores this process may use.

Decoding is bound by memory bandwidth: two threads on one core are slower than one.
"""

from __future__ import annotations

import math
import os
from collections.abc import Collection
from pathlib import Path

SYSTEM = Path("/")


def physical_cores(root: Path = SYSTEM, cpus: Collection[int] | None = None) -> int:
    """The physical cores that this process may run on, at least 1.

    Affinity (``taskset``) and the CPU quota of its control group (a container's limit) count. Where
    the system does not tell cores from threads, every logical processor is a core.

    Args:
        root: Where ``/sys`` and ``/proc`` are found.
        cpus: The logical processors; by default those of the process's affinity.
    """
    usable = sorted(_affinity() if cpus is None else cpus)
    folder = root / "sys/devices/system/cpu"
    siblings = {_text(folder / f"cpu{n}/topology/thread_siblings_list") or str(n) for n in usable}
    return max(1, math.ceil(min(len(siblings), _quota(root))))


def _affinity() -> Collection[int]:
    if hasattr(os, "sched_getaffinity"):
        return os.sched_getaffinity(0)
    return range(os.cpu_count() or 1)


def _quota(root: Path) -> float:
    """The smallest CPU quota of the control groups that the process is in, in processors."""
    groups = [line.split(":", 2)[-1] for line in _text(root / "proc/self/cgroup").splitlines()]
    limits = [math.inf]
    for group in {"/", *groups}:
        here = Path(group.lstrip("/"))
        for level in (here, *here.parents):
            unified = _text(root / "sys/fs/cgroup" / level / "cpu.max").split()
            folder = root / "sys/fs/cgroup/cpu" / level
            legacy = [_text(folder / f"cpu.cfs_{name}_us") for name in ("quota", "period")]
            limits += [_ratio(*pair) for pair in (unified, legacy) if len(pair) == 2]
    return min(limits)


def _ratio(quota: str, period: str) -> float:
    """Processors; infinite for ``max``, for -1, and for what is no number."""
    try:
        processors = int(quota) / int(period)
    except (ValueError, ZeroDivisionError):
        return math.inf
    return processors if processors > 0 else math.inf


def _text(path: Path) -> str:
    try:
        return path.read_text().strip()
    except OSError:
        return ""
