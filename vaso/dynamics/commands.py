"""The set-points of a state, read from the command that is in force there."""

from __future__ import annotations

import ast

from vaso.dynamics.period import SetPoints
from vaso.errors import PlanError
from vaso.platforms import Issued, Platform
from vaso.platforms.response import Response

__all__ = ["issued_in", "setpoints_of"]


def issued_in(text: str, platform: Platform) -> Issued | None:
    """The command that a state shows as text, such as ``set_velocity(velocity=(0.0, 0.0, -0.5))``.

    Returns:
        The command; None where the text is no command of the platform.
    """
    try:
        call = ast.parse(text, mode="eval").body
        if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name) or call.args:
            return None
        command = platform.command(call.func.id)
        given = {k.arg: ast.literal_eval(k.value) for k in call.keywords if k.arg}
        return command.issue((), given) if command else None
    except (SyntaxError, ValueError, PlanError):
        return None


def setpoints_of(issued: Issued | None, response: Response) -> SetPoints | None:
    """The set-point of every channel in a command; None where the platform does not say."""
    if issued is None:
        return None
    arguments = dict(issued.arguments)
    found = [c.setpoint(issued.name, arguments) for c in response.channels]
    return tuple(u for u in found if u is not None) if None not in found else None
