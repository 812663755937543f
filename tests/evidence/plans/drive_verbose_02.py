# skill: drive
# expected: fail
# because: the sleep after forward() lets a period pass without a look at people
"""Move forward 5 meters, then turn left by 90 degrees."""

import math
import time

LINEAR_SPEED: float = 0.3
ANGULAR_SPEED: float = 0.5


def move_forward(distance: float) -> None:
    """Move forward the given distance in meters."""
    duration: float = distance / LINEAR_SPEED
    start: float = time.time()
    while time.time() - start < duration:
        if people_observed() or obstacle_observed():
            stop()
        else:
            forward()
        time.sleep(0.1)
    stop()


def rotate_left(angle_deg: float) -> None:
    """Rotate left by an angle in degrees."""
    duration: float = math.radians(angle_deg) / ANGULAR_SPEED
    start: float = time.time()
    while time.time() - start < duration:
        if people_observed():
            stop()
        else:
            turn_left()
        time.sleep(0.1)
    stop()


move_forward(5.0)
rotate_left(90.0)
