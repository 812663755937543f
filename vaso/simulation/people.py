"""People who walk through a scene."""

from __future__ import annotations

import math

from vaso.errors import SceneError
from vaso.simulation.chance import stream
from vaso.simulation.geometry import Point
from vaso.simulation.scene import Person
from vaso.simulation.world import World

__all__ = ["PERSON_RADIUS", "Walker"]

PERSON_RADIUS = 0.25
"""Half the width of a person's shoulders, in metres."""

_EVADING = 1.5
"""Speed in m/s of a person who steps aside; a robot that is faster is not evaded."""

_TRIES = 50
_LEAST = 1e-3
"""Seconds that even the shortest way takes, so that a walk between equal points ends."""


class Walker:
    """One person, from way-point to way-point, around the robot where it stands in the way.

    Args:
        person: Who walks where.
        world: For those who wander: where there is room.
        seed: Of the run.
        index: Which person of the scene it is.
        distance: How far the middle of a person stays from that of the robot, in metres.

    Attributes:
        at: Where the person is; None once gone.

    Raises:
        SceneError: There is no room in the area to wander in.
    """

    def __init__(
        self, person: Person, world: World, seed: int, index: int, distance: float
    ) -> None:
        self._person = person
        self._world = world
        self._distance = distance
        self._numbers = stream(seed, "way of person", index)
        self._rest = person.delay
        self._next = 1
        self._step = 1
        self.at: Point | None = person.path[0] if person.path else self._drawn(None)
        if self.at is None:
            raise SceneError(
                f"there is no room for {person.name} in the area {person.wander}",
                hint="choose an area with some floor that is 0.25 m from walls and furniture",
            )
        self._goal = self._first_goal()

    def walk(self, seconds: float, robot: Point) -> None:
        """Go on for some time.

        Args:
            seconds: How long.
            robot: Where the robot is.
        """
        while seconds > 1e-9 and self.at is not None:
            if self._rest > 0:
                spent = min(self._rest, seconds)
                self._rest -= spent
            elif self._goal is None:
                return
            else:
                spent = self._towards(self._goal, seconds, robot)
            seconds -= spent

    def _towards(self, goal: Point, seconds: float, robot: Point) -> float:
        assert self.at is not None
        (x, y), way = self.at, math.dist(self.at, goal)
        spent = min(seconds, way / self._person.speed)
        part = spent * self._person.speed / way if way else 1.0
        after = (x + (goal[0] - x) * part, y + (goal[1] - y) * part)
        if math.dist(after, robot) < self._distance:
            if math.dist(goal, robot) < self._distance:
                self._arrived()  # the robot stands there: as near as one can come
                return seconds
            self.at = self._around(after, robot, max(self._person.speed, _EVADING) * seconds)
            return seconds
        self.at = after
        if part >= 1 - 1e-9 or math.dist(after, goal) < 1e-9:
            self._arrived()
        return max(spent, _LEAST)

    def _around(self, wanted: Point, robot: Point, most: float) -> Point:
        """A step aside, to the circle about the robot; none where a wall is in the way."""
        assert self.at is not None and self._goal is not None
        dx, dy = wanted[0] - robot[0], wanted[1] - robot[1]
        angle = math.atan2(dy, dx)
        goal = math.atan2(self._goal[1] - robot[1], self._goal[0] - robot[0])
        turn = 1.0 if math.sin(goal - angle) >= 0 else -1.0
        step = math.dist(self.at, wanted) / self._distance
        for side in (turn, -turn):
            new = angle + side * step
            to = (
                robot[0] + self._distance * math.cos(new),
                robot[1] + self._distance * math.sin(new),
            )
            way = math.dist(self.at, to)
            if way > most:
                (x, y), part = self.at, most / way
                to = (x + (to[0] - x) * part, y + (to[1] - y) * part)
            if self._world.nearest(to, self._world.near(to, PERSON_RADIUS))[0] > 0.1:
                return to
        return self.at

    def _arrived(self) -> None:
        person = self._person
        self._rest = person.pause
        if person.wander is not None:
            self._goal = self._drawn(self.at)
            return
        count = len(person.path)
        self._next += self._step
        if not 0 <= self._next < count:
            if person.then == "leave":
                self.at = None
            if person.then in ("leave", "stay"):
                self._goal = None
                return
            if person.then == "again":
                self._next = 0
            else:
                self._step = -self._step
                self._next += 2 * self._step
        self._goal = person.path[self._next]

    def _first_goal(self) -> Point | None:
        if self._person.wander is not None:
            return self._drawn(self.at)
        return self._person.path[1] if len(self._person.path) > 1 else None

    def _drawn(self, start: Point | None) -> Point | None:
        """A way-point in the area that can be reached in a straight line, if one is found."""
        assert self._person.wander is not None
        (ax, ay), (bx, by) = self._person.wander
        for _ in range(_TRIES):
            point = (self._numbers.uniform(ax, bx), self._numbers.uniform(ay, by))
            if self._world.is_free(start or point, point, PERSON_RADIUS):
                return point
        return start
