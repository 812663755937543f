"""A log file as data: JSON, JSON lines or CSV, each record with its line."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vaso.errors import VasoError

__all__ = ["Item", "bad", "number", "read_items"]

MAX_BYTES = 500_000_000
"""Files larger than this are refused, so that a wrong path cannot fill the memory."""


@dataclass(frozen=True, slots=True)
class Item:
    """A record of a log.

    Attributes:
        data: The record.
        source: The file.
        line: Its line, counted from 1; in a JSON array, the number of the element instead.
        element: Whether ``line`` counts elements.
    """

    data: Mapping[str, Any]
    source: str
    line: int
    element: bool = False


def bad(item: Item, message: str, *, expected: str | None = None) -> VasoError:
    """An error that points to a record."""
    if item.element:
        return VasoError(f"element {item.line}: {message}", source=item.source, expected=expected)
    return VasoError(message, source=item.source, line=item.line, expected=expected)


def number(item: Item, value: object, what: str) -> float:
    """A finite number of a record.

    Raises:
        VasoError: It is none.
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise bad(item, f"{what} is {_short(value)}", expected="a number")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise bad(item, f"{what} is {found}", expected="a finite number")
    return found


def read_items(path: Path) -> list[Item]:
    """Read a log.

    Raises:
        VasoError: It cannot be read, is empty, or is neither JSON, JSON lines nor CSV.
    """
    text = _text(path)
    start = text.lstrip()[:1]
    if not start:
        raise VasoError("the log is empty", source=str(path))
    if start == "[":
        return list(_array(text, path))
    items = list(_lines(text, path) if start == "{" else _rows(text, path))
    if not items:
        raise VasoError("the log has no records", source=str(path))
    return items


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > MAX_BYTES:
            raise VasoError(
                f"the log is larger than {MAX_BYTES // 1_000_000} MB",
                source=str(path),
                hint="convert only the topics or messages that are needed",
            )
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise VasoError(
            "the log is no text",
            source=str(path),
            hint="convert a ROS bag or a MAVLink log to JSON first; docs/shield.md says how",
        ) from error
    except OSError as error:
        reason = error.strerror or str(error)
        raise VasoError(f"the log cannot be read: {reason}", source=str(path)) from error


def _array(text: str, path: Path) -> Iterator[Item]:
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        line = getattr(error, "lineno", None)
        message = getattr(error, "msg", "it is nested too deep")
        raise VasoError(f"no JSON: {message}", source=str(path), line=line) from error
    for index, element in enumerate(data):
        item = Item({}, str(path), index, element=True)
        if not isinstance(element, dict):
            raise bad(item, f"{_short(element)} is no record", expected="an object {…}")
        yield Item(element, str(path), index, element=True)
    if not data:
        raise VasoError("the log is empty", source=str(path))


def _lines(text: str, path: Path) -> Iterator[Item]:
    lines = text.splitlines()
    for index, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            data = json.loads(line)
        except (ValueError, RecursionError) as error:
            if index == len(lines) and index > 1:
                return  # what wrote the log was lost while it wrote this line
            message = getattr(error, "msg", "it is nested too deep")
            raise VasoError(f"no JSON: {message}", source=str(path), line=index) from error
        if not isinstance(data, dict):
            item = Item({}, str(path), index)
            raise bad(item, f"{_short(data)} is no record", expected="an object {…}")
        yield Item(data, str(path), index)


def _rows(text: str, path: Path) -> Iterator[Item]:
    """A CSV file with a header; the cells are numbers, or stay texts."""
    reader = csv.DictReader(text.splitlines())
    names = reader.fieldnames or []
    if len(names) < 2 or any(_number_or_text(n or "") != n for n in names):
        raise VasoError(
            "this is neither JSON nor a table with a header",
            source=str(path),
            line=1,
            expected="JSON lines, a JSON array, or CSV",
        )
    try:
        for row in reader:
            cells = {k: _number_or_text(v) for k, v in row.items() if k and isinstance(v, str)}
            yield Item(cells, str(path), reader.line_num)
    except csv.Error as error:
        raise VasoError(f"no CSV: {error}", source=str(path), line=reader.line_num) from error


def _number_or_text(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _short(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False, default=repr)
    return text if len(text) <= 60 else text[:57] + "..."
