"""On what a comparison was measured."""

from __future__ import annotations

import os
import platform
from datetime import UTC, datetime
from importlib import metadata

from pydantic import BaseModel, ConfigDict

from vaso.bench.machine import describe_machine

PACKAGES = (
    "vaso",
    "dspy",
    "adalflow",
    "gepa",
    "textgrad",
    "pynusmv",
    "pydantic-monty",
    "xllamacpp",
)


class Machine(BaseModel):
    """The machine and the software.

    Attributes:
        description: Processor, cores, system and Python in one line.
        cores: Processor cores that the process may use.
        platform: The system, as Python names it.
        python: Version of Python.
        packages: Versions of the packages that matter, where they are installed.
        started: When the comparison was started, in UTC.
    """

    model_config = ConfigDict(frozen=True)
    description: str = ""
    cores: int = 0
    platform: str = ""
    python: str = ""
    packages: dict[str, str] = {}
    started: str = ""


def this_machine() -> Machine:
    """The machine that this runs on."""
    affinity = getattr(os, "sched_getaffinity", None)
    return Machine(
        description=describe_machine(),
        cores=len(affinity(0)) if affinity else os.cpu_count() or 1,
        platform=platform.platform(),
        python=platform.python_version(),
        packages=_versions(),
        started=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def _versions() -> dict[str, str]:
    found = {}
    for package in PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return found
