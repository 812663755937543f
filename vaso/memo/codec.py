"""Results as JSON and back, exactly: what comes back equals what went in, type by type.

Reading never runs code from the file, as unpickling would: an object in the JSON names one of the
classes below, which are plain records of values.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from enum import Enum
from functools import cache
from importlib import import_module
from typing import Any

__all__ = ["CodecError", "decode", "encode"]

_VERDICTS, _SYSTEMS = "vaso.verdict", "vaso.plan.transition_system"
RECORDS: dict[str, str] = {
    **dict.fromkeys(
        ("Verdict", "Step", "Counterexample", "SpecResult", "Problem", "VerificationResult"),
        _VERDICTS,
    ),
    **dict.fromkeys(("BetweenSamples", "Bound", "Witness"), "vaso.dynamics.result"),
    **dict.fromkeys(
        ("LabelComparison", "LabelReport", "LabelStatus", "LabelWitness"), "vaso.labels.result"
    ),
    **dict.fromkeys(("Branch", "Coverage"), "vaso.verification.coverage"),
    **dict.fromkeys(
        ("LabelStatus", "LabelWitness", "LabelComparison", "LabelReport"), "vaso.labels.result"
    ),
    **dict.fromkeys(("Bound", "Witness", "BetweenSamples"), "vaso.dynamics.result"),
    **dict.fromkeys(("Sensor", "Case", "Edge", "State", "Cut", "TransitionSystem"), _SYSTEMS),
}
"""The classes that can be written, with their modules."""

_LEFT_OUT = {"VerificationResult": frozenset({"system", "from_memo"})}
_SCALARS = frozenset({type(None), bool, int, float, str})


class CodecError(ValueError):
    """A value that cannot be written, or a text that was not written here."""


def encode(value: Any) -> Any:
    """A value as JSON data.

    Arrays are tuples; an object has one entry, whose name says what it is: ``list``, ``map``,
    ``set``, or a class.

    Raises:
        CodecError: It holds something other than scalars, containers and the records above.
    """
    kind: type[Any] = type(value)
    if kind in _SCALARS:
        return value
    if kind is tuple:
        return [encode(item) for item in value]
    if kind is list:
        return {"list": [encode(item) for item in value]}
    if isinstance(value, Mapping):
        return {"map": [[encode(k), encode(v)] for k, v in value.items()]}
    if isinstance(value, frozenset):
        return {"set": sorted((encode(item) for item in value), key=repr)}
    if RECORDS.get(kind.__name__) != kind.__module__:
        raise CodecError(f"a {kind.__name__} cannot be written")
    if isinstance(value, Enum):
        return {kind.__name__: value.value}
    return {kind.__name__: {n: encode(getattr(value, n)) for n in _names(kind.__name__)}}


def decode(data: Any) -> Any:
    """The value that was encoded.

    Raises:
        CodecError: The data are not of that kind.
    """
    if type(data) in _SCALARS:
        return data
    if isinstance(data, list):
        return tuple(decode(item) for item in data)
    if not isinstance(data, dict) or len(data) != 1:
        raise CodecError("not an encoded value")
    ((tag, content),) = data.items()
    try:
        return _record(tag, content) if tag in RECORDS else _CONTAINERS[tag](content)
    except (KeyError, TypeError, ValueError) as error:
        raise CodecError(f"not an encoded {tag}") from error


def _record(tag: str, content: Any) -> Any:
    kind = _kind(tag)
    if issubclass(kind, Enum):
        return kind(content)
    if set(content) != set(_names(tag)):
        raise CodecError(f"a {tag} has other fields now")
    return kind(**{name: decode(value) for name, value in content.items()})


_CONTAINERS: dict[str, Callable[[Any], Any]] = {
    "list": lambda content: [decode(item) for item in content],
    "map": lambda content: {decode(key): decode(value) for key, value in content},
    "set": lambda content: frozenset(decode(item) for item in content),
}


@cache
def _kind(tag: str) -> type[Any]:
    found: type[Any] = getattr(import_module(RECORDS[tag]), tag)
    return found


@cache
def _names(tag: str) -> tuple[str, ...]:
    left_out = _LEFT_OUT.get(tag, frozenset())
    return tuple(f.name for f in fields(_kind(tag)) if f.init and f.name not in left_out)
