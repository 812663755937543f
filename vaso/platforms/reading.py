"""Commands and sensor readings from their text, such as ``velocity_publisher(linear=0.3)``."""

from __future__ import annotations

import ast
from typing import Any

from vaso.errors import VasoError
from vaso.platforms.model import Issued, Platform

__all__ = ["read_call", "read_command"]


def read_call(text: str) -> tuple[str, list[Any], dict[str, Any]] | None:
    """A call with constant arguments: function, arguments, named arguments; None if it is none."""
    try:
        call = ast.parse(text, mode="eval").body
        if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name):
            return None
        arguments = [ast.literal_eval(a) for a in call.args]
        return (
            call.func.id,
            arguments,
            {k.arg or "": ast.literal_eval(k.value) for k in call.keywords},
        )
    except (SyntaxError, ValueError):
        return None


def read_command(text: str, platform: Platform) -> Issued | None:
    """The command that a state's text stands for, or None if it is none of the platform's."""
    call = read_call(text)
    command = platform.command(call[0]) if call else None
    if call is None or command is None:
        return None
    try:
        return command.issue(call[1], call[2])
    except VasoError:
        return None
