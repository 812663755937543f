"""The world of a simulated run as readable data: a floor with walls, things and people, or the air.

Ground scenes are maps in metres: x to the right, y up, headings in degrees from the x axis, left
(counter-clockwise) positive. Air scenes are in metres north and east of an origin.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import Discriminator, Field, Tag, TypeAdapter, model_validator

from vaso.simulation.geometry import Point, Segment, contains, edges, without
from vaso.simulation.things import Finite, Furniture, Item, Length, Metres, Part, Position

__all__ = [
    "AirScene",
    "AnyScene",
    "Doorway",
    "Person",
    "Place",
    "Room",
    "Scene",
    "Start",
    "Wind",
]


class Start(Part):
    """Where the robot is at the beginning.

    Attributes:
        at: Position in metres.
        heading: Degrees.
        spread: Each seed moves the position by up to this many metres.
        heading_spread: And the heading by up to this many degrees.
    """

    at: Position = (0.0, 0.0)
    heading: Finite = 0.0
    spread: Metres = 0.0
    heading_spread: Metres = 0.0


class Room(Part):
    """A room; walls all around it except where a doorway is.

    Attributes:
        name: For example ``kitchen``.
        corners: Two opposite corners of a rectangle, or three and more of a polygon.
        walls: False for an area that is open on all sides.
    """

    name: str
    corners: Annotated[tuple[Position, ...], Field(min_length=2)]
    walls: bool = True

    @property
    def polygon(self) -> tuple[Point, ...]:
        """Its corners in order."""
        if len(self.corners) > 2:
            return self.corners
        (ax, ay), (bx, by) = self.corners
        return ((ax, ay), (bx, ay), (bx, by), (ax, by))


class Doorway(Part):
    """A gap in the walls between its two ends."""

    name: str = "doorway"
    ends: tuple[Position, Position]

    @property
    def at(self) -> Point:
        """Its middle."""
        (ax, ay), (bx, by) = self.ends
        return ((ax + bx) / 2, (ay + by) / 2)


class Place(Part):
    """A named place where nothing stands, such as a hallway entrance."""

    name: str
    at: Position
    radius: Length = 0.5


class Person(Part):
    """Somebody who walks along way-points, walks about, or stands.

    Attributes:
        name: For pictures.
        path: Way-points in metres; with one, the person stands there.
        wander: Two opposite corners of an area; way-points in it are drawn from the seed.
        speed: Metres per second.
        pause: Seconds of rest at each way-point.
        delay: Seconds before the first step.
        then: At the end of the path: walk ``back``, start ``again`` from the first way-point,
            ``stay``, or ``leave`` the scene.
        spread: Each seed moves the path by up to this many metres.
        delay_spread: And adds up to this many seconds to the delay.
    """

    name: str = "person"
    path: tuple[Position, ...] = ()
    wander: tuple[Position, Position] | None = None
    speed: Annotated[float, Field(gt=0, le=3)] = 1.0
    pause: Metres = 2.0
    delay: Metres = 0.0
    then: Literal["back", "again", "stay", "leave"] = "back"
    spread: Metres = 0.0
    delay_spread: Metres = 0.0

    @model_validator(mode="after")
    def _walks(self) -> Self:
        if bool(self.path) == (self.wander is not None):
            raise ValueError("a person has either a path or an area to wander in")
        return self


class Scene(Part):
    """The world of a ground robot.

    Attributes:
        robot: Its start.
        rooms: Rooms, whose sides are walls.
        walls: Further walls, each a line of two or more points.
        doorways: Gaps in walls.
        furniture: What stands about.
        objects: Small things, to be found or to be in the way.
        people: Who walks or stands about.
        places: Named places.
    """

    platform: Literal["jackal"] = "jackal"
    name: str = ""
    description: str = ""
    robot: Start = Start()
    rooms: tuple[Room, ...] = ()
    walls: tuple[Annotated[tuple[Position, ...], Field(min_length=2)], ...] = ()
    doorways: tuple[Doorway, ...] = ()
    furniture: tuple[Furniture, ...] = ()
    objects: tuple[Item, ...] = ()
    people: tuple[Person, ...] = ()
    places: tuple[Place, ...] = ()

    @cached_property
    def wall_segments(self) -> tuple[Segment, ...]:
        """All walls, with the doorways cut out."""
        sides = [s for r in self.rooms if r.walls for s in edges(r.polygon)]
        lines = [s for w in self.walls for s in pairwise(w)]
        gaps = [d.ends for d in self.doorways]
        return tuple(dict.fromkeys(part for s in (*sides, *lines) for part in without(s, gaps)))

    def find(self, name: str) -> Point | None:
        """The middle of the first place, doorway, object, furniture or room of a name or kind."""
        return next((at for known, at in self._named() if known == name), None)

    def _named(self) -> Iterator[tuple[str, Point]]:
        yield from ((p.name, p.at) for p in self.places)
        yield from ((d.name, d.at) for d in self.doorways)
        yield from ((i.kind, i.at) for i in self.objects)
        yield from ((f.kind, f.at) for f in self.furniture)
        yield from ((r.name, _middle(r.polygon)) for r in self.rooms)

    def room_at(self, point: Point) -> str | None:
        """The name of the room that a point is in."""
        return next((r.name for r in self.rooms if contains(r.polygon, point)), None)


class Wind(Part):
    """Wind over an air scene.

    Attributes:
        mean: North, east and down component of where the air goes, in m/s.
        gusts: Standard deviation of each horizontal component about it, in m/s; vertical gusts
            are half as strong.
        time_scale: Seconds for which a gust lasts (correlation time).
        spread: Each seed turns the mean and scales it by up to this part (0.2 is 20 %).
    """

    mean: tuple[Finite, Finite, Finite] = (0.0, 0.0, 0.0)
    gusts: Metres = 0.0
    time_scale: Length = 3.0
    spread: Annotated[float, Field(ge=0, le=1)] = 0.0


class AirScene(Part):
    """The world of a quadcopter: level ground, and the wind.

    Attributes:
        take_off: North and east of the take-off point in metres.
        wind: The wind.
    """

    platform: Literal["px4"] = "px4"
    name: str = ""
    description: str = ""
    take_off: Position = (0.0, 0.0)
    wind: Wind = Wind()


def _which(data: Any) -> str:
    if isinstance(data, dict):
        return str(data.get("platform", "jackal"))
    return str(getattr(data, "platform", "jackal"))


AnyScene: TypeAlias = Annotated[
    Annotated[Scene, Tag("jackal")] | Annotated[AirScene, Tag("px4")],
    Discriminator(
        _which,
        custom_error_type="platform",
        custom_error_message="platform must be jackal (a ground scene) or px4 (an air scene)",
    ),
]
"""A scene of either kind, as its field ``platform`` says."""

SCENE: TypeAdapter[Scene | AirScene] = TypeAdapter(AnyScene)


def _middle(polygon: tuple[Point, ...]) -> Point:
    return (
        sum(x for x, _ in polygon) / len(polygon),
        sum(y for _, y in polygon) / len(polygon),
    )
