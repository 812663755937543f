"""Executors by name."""

from __future__ import annotations

from vaso.errors import VasoError
from vaso.parallel.crew import Crew

__all__ = ["NAMES", "SERIAL", "get_crew"]

SERIAL = "serial"
NAMES = ("processes", "ray", SERIAL)


def get_crew(executor: str | Crew, workers: int | None) -> Crew | None:
    """The crew for an executor; None where plans are verified in this process.

    Raises:
        VasoError: There is no such executor, or no such number of workers.
        MissingDependencyError: Its package is not installed.
    """
    if workers is not None and workers < 1:
        raise VasoError(f"{workers} workers cannot verify anything", expected="at least one")
    if not isinstance(executor, str):
        return executor
    if executor == SERIAL:
        return None
    if executor == "processes":
        from vaso.parallel.processes import ProcessCrew

        return ProcessCrew(workers)
    if executor == "ray":
        from vaso.parallel.ray_crew import RayCrew

        return RayCrew(workers)
    raise VasoError(f"there is no executor '{executor}'", expected=f"one of {', '.join(NAMES)}")
