"""The set-points of a command."""

from __future__ import annotations

from vaso.dynamics.period import SetPoints
from vaso.platforms import Issued
from vaso.platforms.response import Response

__all__ = ["setpoints_of"]


def setpoints_of(issued: Issued | None, response: Response) -> SetPoints | None:
    """The set-point of every channel in a command; None where the platform does not say."""
    if issued is None:
        return None
    arguments = dict(issued.arguments)
    found = [c.setpoint(issued.name, arguments) for c in response.channels]
    return tuple(u for u in found if u is not None) if None not in found else None
