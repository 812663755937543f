"""Where the sandbox keeps the variables of a plan, and where in the plan it is."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from vaso.plan.abstraction.calls import Place, Span
from vaso.plan.abstraction.fields import Single
from vaso.plan.abstraction.forms import GLOBAL, Var
from vaso.plan.abstraction.relevance import Relevance
from vaso.plan.abstraction.scopes import NotAnalysableError

Cell: TypeAlias = tuple[str, int, int]
"""Where a variable is: in ``globals``, ``stack``, ``cell`` or ``object``; the index there; and for
an object, the number of the attribute."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The parts of a snapshot that are looked at.

    Attributes:
        file: The text with the call at which the program waits.
        call: The bytes of that call.
        program: The module's code.
        tables: The sandbox's tables of functions, strings and global names.
        machine: The frames, the stack and the globals.
        heap: The heap's entries.
        shape: The snapshot in its canonical form: the roots (the last two of them the stack and the
            globals), then the heap's entries.
        order: Which entry of the canonical form a slot of the heap is.
    """

    file: str
    call: tuple[int, int]
    program: Mapping[str, Any]
    tables: Mapping[str, Any]
    machine: Mapping[str, Any]
    heap: list[Any]
    shape: list[Any]
    order: Mapping[int, int]


FIRST_NAME = "__vaso__"
"""The first global of every plan, by which the numbering of texts is known."""


class Layout:
    """Where the sandbox keeps the variables of a plan.

    Args:
        snapshot: The first snapshot of the plan.
        relevance: The plan's functions and variables.
        file: What the sandbox calls the plan's text.
    """

    def __init__(self, snapshot: Snapshot, relevance: Relevance, file: str) -> None:
        tables = snapshot.tables
        self._own = relevance.own
        self._spans: dict[int | None, dict[int | None, Span]] = {
            None: _spans(snapshot.program["module_code"])
        }
        self._scopes = relevance.scopes
        self._fields = relevance.fields
        self._names = _Names(tables)
        self._globals = [self._names.of(n) for n in tables["global_names"]["slots"]]
        numbers = _starts(relevance)
        self._functions: dict[int, int] = {}
        self._locals: dict[int, list[str]] = {}
        for index, function in enumerate(tables["interns"]["functions"]):
            at = function["N"]["P"]
            number = numbers.get(at["S"]) if self._names.of(at["F"]) == file else None
            if number is not None:
                self._spans[index] = _spans(function["B"])
                self._functions[index] = number
                self._locals[number] = [self._names.of(n) for n in function["B"]["N"]]

    def here(self, snapshot: Snapshot) -> Place:
        """Where the plan is: the calls that have led there, as far back as they are followed."""
        frames = snapshot.machine["frames"]
        place: Place = (GLOBAL,)
        for caller, frame in itertools.pairwise(frames):
            span = self._spans.get(caller["F"], {}).get(frame["C"])
            if span is not None and (place, span) in self._own:
                place = (*place, span)
            else:
                place = (self._functions.get(frame["F"]),)
        return place

    def running(self, snapshot: Snapshot) -> set[int]:
        """The functions that are running."""
        frames = snapshot.machine["frames"]
        return {self._functions[f["F"]] for f in frames if f["F"] in self._functions}

    def places(self, snapshot: Snapshot) -> dict[Var, Cell] | None:
        """Where the variables are; None if a frame is not one of the plan's."""
        scopes = self._scopes
        found: dict[Var, Cell] = {}
        for slot, name in enumerate(self._globals):
            if name in scopes.module.own and slot < len(snapshot.machine["globals"]):
                found[(GLOBAL, name)] = ("globals", slot, 0)
        for frame in snapshot.machine["frames"]:
            if frame["F"] is None:
                continue
            number = self._functions.get(frame["F"])
            if number is None:
                return None
            for index, name in enumerate(self._locals[number][: frame["L"]]):
                self._add(found, (number, name), frame["S"] + index, snapshot)
        for single in self._fields.classes:
            self._add_object(found, single, snapshot)
        return {var: place for var, place in found.items() if var not in scopes.untracked}

    def _add_object(self, found: dict[Var, Cell], single: Single, snapshot: Snapshot) -> None:
        """The attributes of a class's object, once there is one."""
        for slot in snapshot.order:
            entry = snapshot.heap[slot]["D"].get("I")
            if entry is None or self._class(snapshot.heap[entry["C"]]) != single.node.name:
                continue
            if any(
                place[0] == "object" and var[0] == single.number for var, place in found.items()
            ):
                raise NotAnalysableError(f"two objects of '{single.node.name}'")
            for index, item in enumerate(entry["A"]["E"]):
                name = self._names.of(item["K"].get("T", 0)) if isinstance(item["K"], dict) else ""
                if name in single.fields:
                    found[(single.number, name)] = ("object", slot, index)

    def _class(self, entry: Any) -> str:
        """The name of a class."""
        name = entry["D"].get("A", {}).get("name", {})
        return self._names.of(name["Interned"]) if "Interned" in name else ""

    def _add(self, found: dict[Var, Cell], var: Var, index: int, snapshot: Snapshot) -> None:
        scope = self._scopes.of[self._scopes.functions[var[0]]]
        if self._scopes.owner(var[1], scope) != var:
            return  # a variable of an outer function, found with that one
        cell = snapshot.machine["stack"][index]
        slot = cell.get("C") if isinstance(cell, dict) else None
        if isinstance(slot, int) and slot in snapshot.order and "K" in snapshot.heap[slot]["D"]:
            found[var] = ("cell", slot, 0)
        else:
            found[var] = ("stack", index, 0)


def _spans(code: Mapping[str, Any]) -> dict[int | None, Span]:
    """The bytes of the text that each instruction comes from."""
    return {entry["B"]: (entry["R"]["S"], entry["R"]["E"]) for entry in code["L"]}


class _Names:
    """The sandbox's texts by number. Their numbering starts after its own short texts."""

    def __init__(self, tables: Mapping[str, Any]) -> None:
        self._texts: list[str] = tables["interns"]["strings"]
        self._first = tables["global_names"]["slots"][0] - self._texts.index(FIRST_NAME)

    def of(self, number: int) -> str:
        """The text with a number."""
        if number < 128:
            return chr(number)
        index = number - self._first
        return self._texts[index] if 0 <= index < len(self._texts) else ""


def _starts(relevance: Relevance) -> dict[int, int]:
    """The number of the function whose name (or which, for a lambda) starts at a byte."""
    text = relevance.text.encode()
    starts = [0]
    for line in text.split(b"\n"):
        starts.append(starts[-1] + len(line) + 1)
    found = {}
    for number, node in enumerate(relevance.scopes.functions):
        start = starts[node.lineno - 1] + node.col_offset
        if isinstance(node, ast.FunctionDef):
            start = text.index(node.name.encode(), start + len(b"def"))
        found[start] = number
    return found
