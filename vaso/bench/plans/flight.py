"""Plans for a drone that flies around a square: lists of velocity set-points."""

from __future__ import annotations

import random
from dataclasses import dataclass

__all__ = ["SQUARE"]


@dataclass(frozen=True, slots=True)
class Flight:
    """Numbers of a flight; some of them are too large, as they are in plans of models.

    Attributes:
        side: Side of the square in metres.
        height: Altitude in metres.
        speed: On the sides, in m/s.
        climb: Up and down, in m/s.
        pause: Seconds of standing still at the corners.
    """

    side: float
    height: float
    speed: float
    climb: float
    pause: int

    @classmethod
    def draw(cls, rng: random.Random) -> Flight:
        """Draw a flight."""
        return cls(
            side=rng.choice((2.0, 2.5, 3.0, 4.0, 5.0)),
            height=rng.choice((3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0)),
            speed=rng.choice((0.4, 0.5, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2)),
            climb=rng.choice((0.5, 0.5, 0.8, 1.0, 1.0)),
            pause=rng.choice((0, 1, 1, 2)),
        )


def repeated(rng: random.Random) -> str:
    """Lists times numbers."""
    f = Flight.draw(rng)
    n, up = round(f.side / f.speed), round(f.height / f.climb)
    return (
        f"vel_traj = []\nvel_traj += [(0.0, 0.0, -{f.climb})] * {up}\n{_hover(f)}"
        f"vel_traj += [({f.speed}, 0.0, 0.0)] * {n}\n{_hover(f)}"
        f"vel_traj += [(0.0, {f.speed}, 0.0)] * {n}\n{_hover(f)}"
        f"vel_traj += [(-{f.speed}, 0.0, 0.0)] * {n}\n{_hover(f)}"
        f"vel_traj += [(0.0, -{f.speed}, 0.0)] * {n}\n{_hover(f)}"
        f"vel_traj += [(0.0, 0.0, {f.climb})] * {up}\nvel_traj.append((0.0, 0.0, 0.0))\n"
    )


def segments(rng: random.Random) -> str:
    """A helper for straight segments."""
    f = Flight.draw(rng)
    return (
        "import math\n\n"
        f"side, altitude, speed, climb = {f.side}, {f.height}, {f.speed}, {f.climb}\n\n"
        "def segment(direction, distance, rate):\n"
        "    steps = max(1, math.ceil(distance / rate))\n"
        "    v = distance / steps\n    return [tuple(v * d for d in direction)] * steps\n\n"
        f"hover = [(0.0, 0.0, 0.0)] * {f.pause}\n"
        "vel_traj = segment((0.0, 0.0, -1.0), altitude, climb) + hover\n"
        f"for direction in {_directions(rng)!r}:\n"
        "    vel_traj += segment(direction, side, speed) + hover\n"
        "vel_traj += segment((0.0, 0.0, 1.0), altitude, climb) + [(0.0, 0.0, 0.0)]\n"
    )


def appended(rng: random.Random) -> str:
    """Nested loops that append."""
    f = Flight.draw(rng)
    return (
        f"vel_traj = []\nspeed = {f.speed}\n# take off\n"
        f"for _ in range({round(f.height / f.climb)}):\n"
        f"    vel_traj.append((0.0, 0.0, -{f.climb}))\n"
        f"for dx, dy in {[d[:2] for d in _directions(rng)]!r}:\n"
        f"    for _ in range({f.pause}):\n        vel_traj.append((0.0, 0.0, 0.0))\n"
        f"    for _ in range({round(f.side / f.speed)}):\n"
        "        vel_traj.append((speed * dx, speed * dy, 0.0))\n# land\n"
        f"for _ in range({round(f.height / f.climb) + rng.choice((-1, 0, 0, 1))}):\n"
        f"    vel_traj.append((0.0, 0.0, {f.climb}))\nvel_traj.append((0.0, 0.0, 0.0))\n"
    )


def sent(rng: random.Random) -> str:
    """Set-points that are sent one by one."""
    f = Flight.draw(rng)
    n, up = round(f.side / f.speed), round(f.height / f.climb)
    return (
        "def fly(north, east, down, seconds):\n    for _ in range(seconds):\n"
        "        set_velocity((north, east, down))\n\n"
        f"fly(0.0, 0.0, -{f.climb}, {up})\n"
        + "".join(
            f"fly(0.0, 0.0, 0.0, {f.pause})\nfly({f.speed * x}, {f.speed * y}, 0.0, {n})\n"
            for x, y, _ in _directions(rng)
        )
        + f"fly(0.0, 0.0, 0.0, {f.pause})\nfly(0.0, 0.0, {f.climb}, {up})\n"
        "set_velocity((0.0, 0.0, 0.0))\n"
    )


def _hover(f: Flight) -> str:
    return f"vel_traj += [(0.0, 0.0, 0.0)] * {f.pause}\n" if f.pause else ""


def _directions(rng: random.Random) -> list[tuple[float, float, float]]:
    there = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0)]
    return there if rng.random() < 0.6 else [there[0], there[3], there[2], there[1]]


SQUARE = (repeated, segments, appended, sent)
