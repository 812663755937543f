# skill: fly-in-square-shape-traj
# expected: pass
# because: half a metre per second everywhere, pauses at corners, lands
"""Fly a square of 2 m at 3 m altitude with 0.5 m/s."""

from typing import List, Tuple

Velocity = Tuple[float, float, float]

SIDE_M: float = 2.0
ALTITUDE_M: float = 3.0
SPEED_MPS: float = 0.5
HOVER: Velocity = (0.0, 0.0, 0.0)


def repeat(velocity: Velocity, seconds: int) -> List[Velocity]:
    """A set-point for some seconds."""
    return [velocity] * seconds


def build() -> List[Velocity]:
    """The trajectory."""
    climb = int(ALTITUDE_M / SPEED_MPS)
    side = int(SIDE_M / SPEED_MPS)
    trajectory: List[Velocity] = []
    trajectory += repeat((0.0, 0.0, -SPEED_MPS), climb)
    trajectory.append(HOVER)
    for direction in [(SPEED_MPS, 0.0, 0.0), (0.0, SPEED_MPS, 0.0), (-SPEED_MPS, 0.0, 0.0), (0.0, -SPEED_MPS, 0.0)]:
        trajectory += repeat(direction, side)
        trajectory.append(HOVER)
    trajectory += repeat((0.0, 0.0, SPEED_MPS), climb)
    trajectory.append(HOVER)
    return trajectory


vel_traj = build()
