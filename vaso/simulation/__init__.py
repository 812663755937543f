"""Headless, seeded simulators of the shipped robots, and pictures of what they did."""

from vaso.simulation.camera import Camera
from vaso.simulation.detector import Detector
from vaso.simulation.jackal import JackalSim
from vaso.simulation.reading import load_scene
from vaso.simulation.scene import (
    AirScene,
    AnyScene,
    Doorway,
    Person,
    Place,
    Room,
    Scene,
    Start,
    Wind,
)
from vaso.simulation.things import Furniture, Item
from vaso.simulation.truth import FlightMoment, FlightTruth, GroundMoment, GroundTruth

__all__ = [
    "AirScene",
    "AnyScene",
    "Camera",
    "Detector",
    "Doorway",
    "FlightMoment",
    "FlightTruth",
    "Furniture",
    "GroundMoment",
    "GroundTruth",
    "Item",
    "JackalSim",
    "Person",
    "Place",
    "Room",
    "Scene",
    "Start",
    "Wind",
    "load_scene",
]
