"""The beginning of a GGUF file: is it one, and how long a context was the model trained for?"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from vaso.errors import ModelError
from vaso.local.errors import bad_model

MAGIC = b"GGUF"
VERSIONS = (2, 3)
EXPECTED = "a GGUF file, such as qwen2.5-coder-1.5b-instruct-q4_k_m.gguf"
MAX_TEXT = 10_000_000
"""Bytes of the longest text that a header may have (chat templates are a few thousand)."""

_SCALARS = dict(enumerate(("B", "b", "H", "h", "I", "i", "f", "?"))) | {10: "Q", 11: "q", 12: "d"}
_TEXT, _ARRAY = 8, 9


def context_length(path: Path) -> int | None:
    """The context length that a model was trained for, in tokens; None if the file does not say.

    Args:
        path: The file.

    Raises:
        ModelError: The file cannot be read, is empty or damaged, or is no GGUF file.
    """
    try:
        with path.open("rb") as file:
            return _context_length(file, path)
    except OSError as error:
        raise _bad(path, f"the model cannot be read: {error.strerror or error}") from error
    except (struct.error, ValueError, KeyError, OverflowError, RecursionError) as error:
        raise _bad(path, "the model file is damaged: its header breaks off") from error


def _context_length(file: BinaryIO, path: Path) -> int | None:
    magic = file.read(4)
    if magic != MAGIC:
        what = "the model file is empty" if not magic else "this is not a GGUF file"
        raise _bad(path, what)
    version, _, count = _unpack(file, "<IQQ")
    if version not in VERSIONS:
        raise _bad(path, f"GGUF version {version} is not supported")
    for key, value in _pairs(file, count):
        if key.endswith(".context_length"):
            return int(value)
    return None


def _pairs(file: BinaryIO, count: int) -> Iterator[tuple[str, Any]]:
    for _ in range(count):
        key = _text(file)
        (kind,) = _unpack(file, "<I")
        yield key, _value(file, kind)


def _value(file: BinaryIO, kind: int) -> Any:
    if kind == _TEXT:
        return _text(file)
    if kind != _ARRAY:
        return _unpack(file, "<" + _SCALARS[kind])[0]
    inner, length = _unpack(file, "<IQ")
    if inner in _SCALARS:
        file.seek(length * struct.calcsize("<" + _SCALARS[inner]), 1)
        return None
    for _ in range(length):
        _value(file, inner)
    return None


def _text(file: BinaryIO) -> str:
    (length,) = _unpack(file, "<Q")
    if length > MAX_TEXT:
        raise struct.error("text too long")
    return file.read(length).decode()


def _unpack(file: BinaryIO, shape: str) -> tuple[Any, ...]:
    return struct.unpack(shape, file.read(struct.calcsize(shape)))


def _bad(path: Path, message: str) -> ModelError:
    return bad_model(message, source=str(path), expected=EXPECTED)
