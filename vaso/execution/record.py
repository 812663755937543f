"""What happened in a run: one record for each state, as JSON lines.

The first line of a log is a :class:`Header`, the last a :class:`Ending`, and each line between them
a :class:`Record`. A log whose last lines are missing (a lost process) can be read all the same.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, TextIO

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from vaso.errors import VasoError
from vaso.plan.transition_system import Label, Scalar
from vaso.platforms.model import Value

__all__ = ["Ending", "Header", "Intervention", "Record", "RunLog", "Writer", "read_log"]


class _Line(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Header(_Line):
    """What was run, on what."""

    kind: Literal["run"] = "run"
    skill: str
    platform: str
    robot: str
    dt: float
    plan: str
    task: str = ""
    vaso: str = ""
    started: str = ""
    verdict: str = ""
    shield: bool = True


class Intervention(_Line):
    """The shield has put another command in the place of the plan's.

    Attributes:
        wanted: The command that the plan asked for.
        rule: The rule that it would have violated.
        reason: Why, in words.
    """

    wanted: str
    rule: str
    reason: str


class Record(_Line):
    """One state of a run: the command in force, and what held at the end of its period.

    Attributes:
        step: Number of the state, from 0 (at rest, before the first command).
        time: The robot's clock in seconds since the start.
        command: Name of the low-level command in force.
        arguments: Its arguments by parameter.
        api: The plan's call that issued it, or an empty string.
        line: The plan line of that call.
        sensors: Raw sensor readings in this state.
        labels: Every proposition's value in this state.
        measured: Numbers that the robot has measured.
        overrun: By how much the period ended too late, in seconds.
        intervention: What the shield changed, if it did.
        note: Remark, such as "the plan has ended".
    """

    kind: Literal["state"] = "state"
    step: int
    time: float
    command: str
    arguments: dict[str, Value] = Field(default_factory=dict)
    api: str = ""
    line: int | None = None
    sensors: dict[str, Scalar] = Field(default_factory=dict)
    labels: dict[str, Label] = Field(default_factory=dict)
    measured: dict[str, float] = Field(default_factory=dict)
    overrun: float = 0.0
    intervention: Intervention | None = None
    note: str = ""


class Ending(_Line):
    """How a run ended.

    Attributes:
        outcome: ``finished`` (the plan has ended), ``stopped`` (by the user, or after the time
            that was given), ``aborted`` (something went wrong).
        reason: Why, in words.
        details: What the robot adds: a landing, a disarm.
    """

    kind: Literal["end"] = "end"
    outcome: Literal["finished", "stopped", "aborted"]
    reason: str = ""
    details: dict[str, Any] = Field(default_factory=dict)


class RunLog(BaseModel):
    """A whole log."""

    header: Header
    records: tuple[Record, ...] = ()
    ending: Ending | None = None


class Writer:
    """Writes a log line by line, so that nothing is lost with the process.

    Args:
        path: The file, or None to write nothing.
        header: Its first line.

    Raises:
        VasoError: The file cannot be written.
    """

    def __init__(self, path: Path | None, header: Header) -> None:
        self.header = header
        self.records: list[Record] = []
        self.ending: Ending | None = None
        self._file: TextIO | None = None
        if path is not None:
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
                self._file = path.open("w", encoding="utf-8")
            except OSError as error:
                raise _unwritable(error, path) from error
        self._path = path
        self._write(header)

    def add(self, record: Record) -> None:
        """Add a state.

        Raises:
            VasoError: The file cannot be written.
        """
        self.records.append(record)
        self._write(record)

    def end(self, ending: Ending) -> RunLog:
        """Add the end, and close the file. A log that cannot be written has no end."""
        self.ending = ending
        with contextlib.suppress(VasoError):
            self._write(ending)
        if self._file is not None:
            with contextlib.suppress(OSError):
                self._file.close()
            self._file = None
        return self.log

    @property
    def log(self) -> RunLog:
        """The log so far."""
        return RunLog(header=self.header, records=tuple(self.records), ending=self.ending)

    def _write(self, line: BaseModel) -> None:
        if self._file is None:
            return
        try:
            self._file.write(line.model_dump_json(exclude_defaults=False) + "\n")
            self._file.flush()
        except OSError as error:
            raise _unwritable(error, self._path) from error


def _unwritable(error: OSError, path: Path | None) -> VasoError:
    return VasoError(f"the log cannot be written: {error.strerror}", source=str(path))


_LINE: TypeAdapter[Header | Record | Ending] = TypeAdapter(
    Annotated[Header | Record | Ending, Field(discriminator="kind")]
)


def read_log(path: str | Path) -> RunLog:
    """Read a log.

    Raises:
        VasoError: It is not there, is no log, or is damaged before its last line.
    """
    path = Path(path)
    header: Header | None = None
    records: list[Record] = []
    ending: Ending | None = None
    for line in _lines(path):
        match line:
            case Header():
                header = line
            case Record():
                records.append(line)
            case Ending():
                ending = line
    if header is None:
        raise VasoError(
            "this is no log of a run", source=str(path), expected='a first line with "kind": "run"'
        )
    return RunLog(header=header, records=tuple(records), ending=ending)


def _lines(path: Path) -> Iterator[Header | Record | Ending]:
    try:
        texts = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise VasoError(f"the log cannot be read: {error}", source=str(path)) from error
    for number, text in enumerate(texts, 1):
        try:
            yield _LINE.validate_json(text)
        except ValidationError as error:
            if number == len(texts) and number > 1 and not _is_json(text):
                return  # the process was lost while it wrote this line
            first = error.errors(include_url=False)[0]
            place = ".".join(str(p) for p in first["loc"])
            raise VasoError(
                f"not a line of a log: {place + ': ' if place else ''}{first['msg']}",
                source=str(path),
                line=number,
            ) from error


def _is_json(text: str) -> bool:
    try:
        json.loads(text)
    except (ValueError, RecursionError):
        return False
    return True
