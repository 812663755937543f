"""How a differential-drive base moves: velocities that follow set-points, and arcs."""

from __future__ import annotations

import math

from vaso.dynamics.decay import Decay
from vaso.platforms import Channel
from vaso.simulation.world import Pose

__all__ = ["along", "follow"]


def follow(channel: Channel, velocity: float, wanted: float, seconds: float) -> tuple[float, float]:
    """A velocity under a set-point: exact, for the slowest vehicle that the channel allows.

    Args:
        channel: Its lag and its limit of acceleration.
        velocity: Now.
        wanted: The set-point.
        seconds: For how long.

    Returns:
        The velocity afterwards, and the distance covered meanwhile.
    """
    error = velocity - wanted
    if error == 0:
        return wanted, wanted * seconds
    decay = Decay(channel.lags[1], channel.accelerations[0], abs(error))
    return wanted + error * decay.left(seconds), wanted * seconds + error * decay.area(seconds)


def along(pose: Pose, ahead: float, turn: float) -> Pose:
    """A pose moved along an arc.

    Args:
        pose: Where from.
        ahead: Length of the arc in metres; negative for backwards.
        turn: Change of the heading in radians.
    """
    if ahead == 0:
        return Pose(pose.x, pose.y, pose.heading + turn) if turn else pose
    chord = ahead * (math.sin(turn / 2) / (turn / 2) if abs(turn) > 1e-9 else 1.0)
    middle = pose.heading + turn / 2
    return Pose(
        pose.x + chord * math.cos(middle), pose.y + chord * math.sin(middle), pose.heading + turn
    )
