"""The state of a running CPython program, as far as it can influence what the program does next."""

from __future__ import annotations

import types
from collections.abc import Hashable, Mapping
from typing import Any

_MODULES = (types.ModuleType, types.SimpleNamespace)
_PLAIN = (bool, int, float, str, bytes, type(None))


def fingerprint(frame: types.FrameType | None, names: Mapping[str, Any]) -> Hashable:
    """The frames from the plan's own down, with positions and variables, and its module's names.

    Args:
        frame: The frame of the call that is looked at.
        names: The plan's module; what is bound to functions of the host is left out.
    """
    found: list[Hashable] = []
    seen: dict[int, int] = {}
    while frame is not None:
        if frame.f_code.co_filename == "<plan>":
            inside = frame.f_locals is not frame.f_globals
            values = _value(frame.f_locals, seen) if inside else ()
            found.append((id(frame.f_code), frame.f_lasti, values))
        frame = frame.f_back
    return (*found, _value(dict(names), seen))


def _value(value: Any, seen: dict[int, int]) -> Hashable:
    """A hashable picture of a value; equal pictures mean equal values, shared parts included."""
    if isinstance(value, _PLAIN):
        return type(value).__name__, repr(value)
    if id(value) in seen:
        return "again", seen[id(value)]
    seen[id(value)] = len(seen)
    if isinstance(value, dict):
        items = [(k, v) for k, v in value.items() if k != "__builtins__"]
        return "dict", tuple((_value(k, seen), _value(v, seen)) for k, v in items)
    if isinstance(value, (list, tuple)):
        return type(value).__name__, tuple(_value(v, seen) for v in value)
    if isinstance(value, (set, frozenset)):
        return "set", tuple(sorted(map(repr, value)))
    return _object(value, seen)


def _object(value: Any, seen: dict[int, int]) -> Hashable:
    if isinstance(value, types.FunctionType):
        if value.__code__.co_filename != "<plan>":
            return "function of the host", id(value)
        cells = [c.cell_contents for c in value.__closure__ or ()]
        return "function", id(value.__code__), tuple(_value(c, seen) for c in cells)
    if isinstance(value, types.MethodType):
        return "method", id(value.__func__), _value(value.__self__, seen)
    if hasattr(value, "__length_hint__"):
        return type(value).__name__, value.__length_hint__()
    if isinstance(value, (type, *_MODULES)) or not hasattr(value, "__dict__"):
        return type(value).__name__, id(value)
    return type(value).__name__, _value(vars(value), seen)
