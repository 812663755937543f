"""Decode the sandbox's dumps quickly: most of a dump is the same in every dump of a program."""

from __future__ import annotations

import io
from functools import cache
from typing import Any

import cbor2

_HEAD = 48
"""So many bytes of a part are looked for, before the rest is compared."""

_CONSTANT = ("program", "tables")
"""Keys of the executor whose values are the program itself."""


class DumpReader:
    """Decodes the dumps of one program.

    The program's code and the modules that it imports make up most of a dump. Their bytes are found
    in the first dump; in later ones they are cut out before decoding, and the objects that they
    stand for are put back. Where they are not found in their places, everything is decoded.
    """

    def __init__(self) -> None:
        self._known: list[tuple[bytes, Any]] | None = None

    def read(self, document: bytes) -> Any:
        """The document of a dump (without the header). Objects that did not change are shared."""
        if self._known is None:
            whole = cbor2.loads(document)
            self._known = [*_constants(document, whole), *_modules(document, whole)]
            return whole
        short = document
        for number, (part, _) in enumerate(self._known):
            at = short.find(part[:_HEAD])
            if at < 0 or not short.startswith(part, at):
                return cbor2.loads(document)
            short = b"".join((short[:at], _placeholder(number), short[at + len(part) :]))
        return self._restored(cbor2.loads(short)) or cbor2.loads(document)

    def _restored(self, document: Any) -> Any:
        """Put the objects back; None if one is missing."""
        assert self._known is not None
        objects = {_mark(number): value for number, (_, value) in enumerate(self._known)}
        try:
            snapshot = _snapshot(document)
            for key in _CONSTANT:
                mark = snapshot["executor"][key]
                snapshot["executor"][key] = objects.pop(mark)
            for entry in snapshot["repl"]["heap"]["entries"]:
                module = entry and entry["D"].get("Module")
                if isinstance(module, str):
                    entry["D"]["Module"] = objects.pop(module)
        except (KeyError, TypeError, AttributeError):
            return None
        return None if objects else document


def _mark(number: int) -> str:
    return f"\0part {number:04}"


@cache
def _placeholder(number: int) -> bytes:
    return bytes(cbor2.dumps(_mark(number)))


def _snapshot(document: Any) -> Any:
    (suspended,) = document["state"].values()
    (call,) = suspended.values()
    return call["snapshot"]


def _constants(document: bytes, whole: Any) -> list[tuple[bytes, Any]]:
    executor = _snapshot(whole)["executor"]
    found = ((_value(document, key, executor[key]), executor[key]) for key in _CONSTANT)
    return [(part, value) for part, value in found if part]


def _modules(document: bytes, whole: Any) -> list[tuple[bytes, Any]]:
    entries = _snapshot(whole)["repl"]["heap"]["entries"]
    modules = [e["D"]["Module"] for e in entries if e and "Module" in e["D"]]
    found = ((_value(document, "Module", module), module) for module in modules)
    return [(part, value) for part, value in found if part]


def _value(document: bytes, key: str, value: Any) -> bytes:
    """The bytes of a key's value; empty if they are not found."""
    label, start, text = cbor2.dumps(key), 0, repr(value)  # math.nan is not equal to itself
    while (start := document.find(label, start)) >= 0:
        start += len(label)
        stream = io.BytesIO(document[start:])
        try:
            if repr(cbor2.CBORDecoder(stream, read_size=1).decode()) == text:
                return document[start : start + stream.tell()]
        except (cbor2.CBORDecodeError, TypeError):
            continue
    return b""
