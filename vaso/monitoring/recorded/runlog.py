"""VASO's own log of a run as a recording."""

from __future__ import annotations

from pathlib import Path

from vaso.errors import PlanError, VasoError
from vaso.execution.record import Record, read_log
from vaso.monitoring.recorded.recording import Recording, Sample
from vaso.platforms import Issued, Platform

__all__ = ["read_run_log"]


def read_run_log(path: Path, platform: Platform) -> Recording:
    """Read a log of ``vaso run``.

    Raises:
        VasoError: It cannot be read, or a command in it does not take its arguments.
    """
    log = read_log(path)
    return Recording(
        source=str(path),
        kind="run log",
        dt=log.header.dt,
        samples=tuple(_sample(record, platform, str(path)) for record in log.records),
        skill=log.header.skill,
        platform=log.header.platform,
        plan=log.header.plan,
        task=log.header.task,
    )


def _sample(record: Record, platform: Platform, source: str) -> Sample:
    issued = Issued(name=record.command, arguments=tuple(record.arguments.items()))
    command = platform.command(record.command)
    if command is not None:
        try:
            issued = command.issue((), record.arguments)
        except PlanError as error:
            raise VasoError(f"state {record.step}: {error.message}", source=source) from error
    note = record.note
    if record.intervention is not None:
        note = "; ".join(filter(None, (note, f"the shield replaced {record.intervention.wanted}")))
    return Sample(
        time=record.time,
        command=str(issued),
        issued=issued if command is not None else None,
        api=record.api,
        line=record.line,
        sensors=record.sensors,
        labels=record.labels,
        measured=record.measured,
        note=note,
    )
