"""Headless, seeded simulators of the shipped robots, and pictures of what they did."""

from vaso.simulation.camera import Camera
from vaso.simulation.detector import Detector
from vaso.simulation.jackal import JackalSim
from vaso.simulation.multirotor import Body
from vaso.simulation.px4 import PX4Sim
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
    "Body",
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
    "PX4Sim",
    "Person",
    "Place",
    "Room",
    "Scene",
    "Start",
    "Wind",
    "load_scene",
]
