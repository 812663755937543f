"""The functions of a skill's labelling code in CPython, and the commands that they send."""

from __future__ import annotations

import inspect
import math
import types
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

from vaso.platforms import Issued, get_platform

FILE = "<labelling code>"


@cache
def compiled(code: str) -> types.CodeType:
    """The labelling code, compiled under a file name that :func:`functions_of` knows."""
    return compile(code, FILE, "exec")


@cache
def sent_commands(code: str, platform: str) -> Mapping[str, Issued | None]:
    """For each function of the labelling code, the one command that it sends, if it does."""
    robot, sent = get_platform(platform), list[Issued]()
    names: dict[str, Any] = {"math": math}
    for command in robot.commands:
        names[command.name] = lambda *a, c=command, **k: sent.append(c.issue(a, k))
    for sensor in robot.sensors:
        names[sensor.name] = lambda *_, **__: False
    exec(compiled(code), names)
    found: dict[str, Issued | None] = {}
    for name, function in functions_of(names).items():
        sent.clear()
        if not inspect.signature(function).parameters:
            function()
        found[name] = sent[0] if len(sent) == 1 else None
    return found


def functions_of(names: Mapping[str, Any]) -> dict[str, Callable[..., Any]]:
    """The functions that the labelling code defines."""
    return {
        n: f
        for n, f in names.items()
        if isinstance(f, types.FunctionType) and f.__code__.co_filename == FILE
    }
