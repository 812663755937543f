# skill: drive
# expected: fail
# because: people are not looked at while turning
"""Move forward for 2 meters and rotate right by 45 degrees."""

import math


def go(distance: float) -> None:
    """Advance carefully."""
    for _ in range(round(distance / 0.03)):
        while people_observed() or obstacle_observed():
            stop()
        forward()


def rotate(angle: float) -> None:
    """Rotate on the spot."""
    for _ in range(round(math.radians(angle) / 0.05)):
        turn_right()


go(2.0)
rotate(45.0)
stop()
