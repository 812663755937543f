"""Robots that VASO knows: ``jackal``, ``px4``, and any platform defined in a small file."""

from vaso.platforms.loading import get_platform
from vaso.platforms.model import (
    Command,
    Dynamics,
    Issued,
    Parameter,
    Platform,
    PropositionSpec,
    SensorSpec,
)
from vaso.platforms.response import (
    Channel,
    Greatest,
    Position,
    Response,
    SetPoint,
    Speed,
    Velocity,
)

__all__ = [
    "Channel",
    "Command",
    "Dynamics",
    "Greatest",
    "Issued",
    "Parameter",
    "Platform",
    "Position",
    "PropositionSpec",
    "Response",
    "SensorSpec",
    "SetPoint",
    "Speed",
    "Velocity",
    "get_platform",
]
