"""Headless, seeded simulators of the shipped robots, and pictures of what they did."""

from vaso.simulation.reading import load_scene
from vaso.simulation.scene import (
    AirScene,
    AnyScene,
    Doorway,
    Furniture,
    Item,
    Person,
    Place,
    Room,
    Scene,
    Start,
    Wind,
)

__all__ = [
    "AirScene",
    "AnyScene",
    "Doorway",
    "Furniture",
    "Item",
    "Person",
    "Place",
    "Room",
    "Scene",
    "Start",
    "Wind",
    "load_scene",
]
