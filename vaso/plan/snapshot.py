"""Canonical identity of a sandbox snapshot.

A dump of the sandbox is a header and a CBOR document. Equal program states do not give equal
bytes: call counters, garbage-collector bookkeeping, colours and the numbering of heap slots differ.
:func:`state_key` removes what cannot influence behaviour and renumbers the heap in the order in
which a traversal from the roots meets it. Two states with equal keys behave alike; two alike states
may get different keys, which costs states and never soundness. For that reason anything whose shape
is not known here switches the whole snapshot to its raw numbering.
"""

from __future__ import annotations

import hashlib
from typing import Any

from vaso.errors import VerifierError
from vaso.plan.abstraction import Quotient, Snapshot, View
from vaso.plan.dump import DumpReader

MAGIC = b"MONTY\0"
VERSION = b"\x0e\x00"
"""Dump format of the pinned pydantic-monty; a test fails loudly when it changes."""

_CLOCK = "Time"
"""How a dump calls a read of the clock."""

_HEADER = len(MAGIC) + len(VERSION)

# Heap entry tags whose payload holds references only in the form {"C": slot}.
_PLAIN = frozenset(
    {
        "T", "L", "D", "E", "F", "S", "G", "K", "B", "U", "M", "X", "Q", "RangeIterator",
        "Range", "ExtFunction", "Partial", "Slice", "A", "DataclassField"
    }
)  # fmt: skip
# Heap entry tags with further references: payload key -> how the slot is written.
_SLOTTED = {
    "C": ("C", "list"),
    "I": ("C", "int"),
    "ListIterator": ("list", "int"),
    "DictItemIterator": ("dict", "int"),
    "DictKeyIterator": ("dict", "int"),
    "DictValueIterator": ("dict", "int"),
    "TupleIterator": ("source", "kind"),
    "SetIterator": ("source", "kind"),
    "StringIterator": ("source", "kind"),
    "N": ("class_id", "int"),
}
_VOLATILE_HEAP = frozenset({"entries", "tracker", "allocations_since_gc", "purple_count"})


_NESTED = frozenset({dict, list})

_REFERENCE, _HASH = "{'C': ", "'H': "
"""How a reference to the heap, and the hash of a dictionary's key, show in an item's ``repr``."""

_VARIABLES = ("stack", "globals")
"""The parts of the machine that hold the program's variables."""


def _is_special(text: str) -> bool:
    """True if an item may hold references or hashes (asking its text is quicker than a walk)."""
    return _REFERENCE in text or _HASH in text


class _UnknownShape(Exception):
    """A part of the snapshot whose references cannot be told from numbers."""


class KeyMaker:
    """Computes keys for the snapshots of one program; remembers its constant part.

    Args:
        quotient: Says what of the program's numbers matters, if that is known.

    Attributes:
        raw: How many snapshots had to keep their raw numbering.
    """

    def __init__(self, quotient: Quotient | None = None) -> None:
        self._quotient = quotient
        self._reader = DumpReader()
        self._tables: Any = None
        self._tables_key = b""
        self._modules = _Modules()
        self.raw = 0

    def __call__(self, dump: bytes) -> tuple[bytes, View | None]:
        """The canonical key of a suspended snapshot, and what its future can look at of it.

        Raises:
            VerifierError: The dump is not in the format of the pinned sandbox version.
        """
        if dump[:_HEADER] != MAGIC + VERSION:
            raise VerifierError(
                "the sandbox writes snapshots in a format this version of VASO does not know",
                hint="install the pinned version of pydantic-monty (uv sync)",
            )
        kind, call = _only(_only(self._reader.read(dump[_HEADER:])["state"])[1])
        snapshot = call["snapshot"]
        if self._quotient is not None and _CLOCK in call.get("function_call", ()):
            at = call["position"]
            self._quotient.check_clock(at["filename"], (at["start"], at["end"]))
        heap = snapshot["repl"]["heap"]
        roots = _roots(kind, call, snapshot)
        rest = {k: v for k, v in heap.items() if k not in _VOLATILE_HEAP}
        traversal = _Traversal(heap["entries"], self._modules)
        try:
            body = traversal.run(roots)
        except _UnknownShape:
            self.raw += 1
            body, view = [roots, [_raw(e) for e in heap["entries"]]], None
        else:
            view = self._view(call, snapshot, traversal, [*body[0], body[1], rest])
        constant = self._constant(snapshot)
        if view is not None:
            return view.exact + constant, view
        text = repr([body, rest, constant])
        return hashlib.blake2b(text.encode(), digest_size=16).digest(), view

    def _view(
        self,
        call: dict[str, Any],
        snapshot: dict[str, Any],
        traversal: _Traversal,
        shape: list[Any],
    ) -> View | None:
        if self._quotient is None or "function_name" not in call:
            return None
        at = call["position"]
        return self._quotient.view(
            Snapshot(
                file=at["filename"],
                call=(at["start"], at["end"]),
                program=snapshot["executor"]["program"],
                tables=snapshot["executor"]["tables"],
                machine=snapshot["vm_state"],
                heap=traversal.entries,
                shape=shape,
                order=traversal.number,
            )
        )

    def _constant(self, snapshot: dict[str, Any]) -> bytes:
        """Key of the code tables, which hardly ever change between snapshots of one program."""
        program = {k: v for k, v in snapshot["executor"].items() if k != "heap_capacity"}
        tables = [program, snapshot["repl"]["interns"], snapshot["repl"]["globals"]]
        if tables != self._tables:
            self._tables = tables
            self._tables_key = hashlib.blake2b(repr(tables).encode(), digest_size=16).digest()
        return self._tables_key


def _only(mapping: dict[str, Any]) -> tuple[str, Any]:
    ((key, value),) = mapping.items()
    return key, value


def _roots(kind: str, call: dict[str, Any], snapshot: dict[str, Any]) -> list[Any]:
    machine = dict(snapshot["vm_state"])
    scheduler = {k: v for k, v in machine.pop("scheduler").items() if k != "next_call_id"}
    pending = {k: v for k, v in call.items() if k not in ("snapshot", "call_id")}
    return [kind, pending, machine, scheduler]


def _raw(entry: Any) -> Any:
    return None if entry is None else entry["D"]


class _Modules:
    """Numbers for the plain attributes of modules, of which there are many."""

    def __init__(self) -> None:
        self._numbers: dict[str, int] = {}
        self._seen: dict[int, tuple[Any, int, list[Any]]] = {}

    def of(self, payload: dict[str, Any]) -> tuple[int, list[Any]]:
        """The number of a module's plain attributes, and its attributes that are references."""
        known = self._seen.get(id(payload))
        if known is None or known[0] is not payload:
            items = payload["attrs"]["E"]
            refers = [isinstance(i["V"], dict) and "C" in i["V"] for i in items]
            plain = [i for i, r in zip(items, refers, strict=True) if not r]
            references = [i for i, r in zip(items, refers, strict=True) if r]
            text = repr([payload["name"], plain])
            number = self._numbers.setdefault(text, len(self._numbers))
            known = self._seen[id(payload)] = (payload, number, references)
        return known[1], known[2]


class _Traversal:
    """Visits the heap from the roots and gives slots numbers in order of the visit."""

    def __init__(self, entries: list[Any], modules: _Modules) -> None:
        self.entries = entries
        self.modules = modules
        self.number: dict[int, int] = {}
        self.queue: list[int] = []

    def run(self, roots: list[Any]) -> list[Any]:
        if any(frame.get("N") is not None for frame in roots[2]["frames"]):
            raise _UnknownShape
        kind, pending, machine, scheduler = roots
        rest = {k: v for k, v in machine.items() if k not in ("frames", *_VARIABLES)}
        others, frames = self.text([kind, pending, rest, scheduler]), repr(machine["frames"])
        variables = [self.value(machine[k]) for k in _VARIABLES]
        shape: list[Any] = [[others, frames, *variables]]
        while len(shape) <= len(self.queue):
            shape.append(self.entry(self.entries[self.queue[len(shape) - 1]]))
        unseen = [
            (slot, _raw(e))
            for slot, e in enumerate(self.entries)
            if e is not None and slot not in self.number and slot != 0
        ]
        return [shape, unseen]

    def reference(self, slot: int | None) -> list[Any]:
        if slot is None:
            raise _UnknownShape
        if slot not in self.number:
            self.number[slot] = len(self.number)
            self.queue.append(slot)
        return ["ref", self.number[slot]]

    def value(self, item: Any) -> Any:
        """An item with its references numbered in order of the visit, and without hashes."""
        return self.walked(item) if type(item) in _NESTED and _is_special(repr(item)) else item

    def text(self, item: Any) -> str:
        """The same as text."""
        text = repr(item)
        return repr(self.walked(item)) if _is_special(text) else text

    def walked(self, item: dict[str, Any] | list[Any]) -> Any:
        if type(item) is list:
            return [self.walked(v) if type(v) in _NESTED else v for v in item]
        assert isinstance(item, dict)
        if len(item) == 1:
            ((key, value),) = item.items()
            if key == "C" and isinstance(value, int):
                return self.reference(value)
            return {key: self.walked(value)} if type(value) in _NESTED else item
        hashed = "H" in item and "V" in item
        return {
            k: self.walked(v) if type(v) in _NESTED else v
            for k, v in item.items()
            if not (hashed and k == "H")
        }

    def entry(self, entry: dict[str, Any]) -> Any:
        tag, payload = _only(entry["D"])
        if tag == "Module":
            return [tag, self.module(payload)]
        if tag in _PLAIN:
            if tag == "X" and payload.get("data") != "None":
                raise _UnknownShape
            if tag == "U" and payload.get("G") is not None:
                raise _UnknownShape
            return [tag, self.value(payload)]
        if tag not in _SLOTTED:
            raise _UnknownShape
        return [tag, self.slotted(payload, *_SLOTTED[tag])]

    def module(self, payload: dict[str, Any]) -> list[Any]:
        """A module: its plain attributes as a number (there are many), its references visited."""
        number, references = self.modules.of(payload)
        return [number, self.value(references)]

    def slotted(self, payload: dict[str, Any], key: str, form: str) -> list[Any]:
        if payload.get("G") is not None:
            raise _UnknownShape
        slots = payload[key]
        rest = self.value({k: v for k, v in payload.items() if k != key})
        if form == "list":
            return [rest, [self.reference(s) for s in slots]]
        if form == "int":
            return [rest, self.reference(slots)]
        kind, slot = _only(slots)
        return [rest, kind, slot if kind == "Intern" else self.reference(slot)]
