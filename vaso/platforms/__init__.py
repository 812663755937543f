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

__all__ = [
    "Command",
    "Dynamics",
    "Issued",
    "Parameter",
    "Platform",
    "PropositionSpec",
    "SensorSpec",
    "get_platform",
]
