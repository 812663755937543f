"""Where the things of a scene are in the run of one seed."""

from __future__ import annotations

from typing import TypeVar

from vaso.simulation.chance import disc, stream
from vaso.simulation.geometry import Point
from vaso.simulation.scene import Person, Scene, Start
from vaso.simulation.things import Furniture, Item

__all__ = ["place"]

Thing = TypeVar("Thing", Furniture, Item)


def place(scene: Scene, seed: int) -> Scene:
    """The scene with everything moved within its ``spread``, as the seed says.

    Args:
        scene: A scene.
        seed: Of the run.

    Returns:
        A scene in which nothing is left to chance but the way-points of people who wander.
    """
    return scene.model_copy(
        update={
            "robot": _start(scene.robot, seed),
            "furniture": tuple(_thing(f, seed, i) for i, f in enumerate(scene.furniture)),
            "objects": tuple(_thing(o, seed, i) for i, o in enumerate(scene.objects)),
            "people": tuple(_person(p, seed, i) for i, p in enumerate(scene.people)),
        }
    )


def _start(start: Start, seed: int) -> Start:
    numbers = stream(seed, "start")
    at = _moved(start.at, disc(numbers, start.spread))
    turn = numbers.uniform(-start.heading_spread, start.heading_spread)
    return Start(at=at, heading=start.heading + turn)


def _thing(thing: Thing, seed: int, index: int) -> Thing:
    if not thing.spread:
        return thing
    offset = disc(stream(seed, type(thing).__name__, index), thing.spread)
    return thing.model_copy(update={"at": _moved(thing.at, offset), "spread": 0.0})


def _person(person: Person, seed: int, index: int) -> Person:
    numbers = stream(seed, "place of person", index)
    offset = disc(numbers, person.spread)
    delay = person.delay + numbers.uniform(0.0, person.delay_spread)
    path = tuple(_moved(p, offset) for p in person.path)
    return person.model_copy(
        update={"path": path, "delay": delay, "spread": 0.0, "delay_spread": 0.0}
    )


def _moved(at: Point, by: Point) -> Point:
    return (at[0] + by[0], at[1] + by[1])
