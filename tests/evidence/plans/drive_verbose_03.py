# skill: drive
# expected: fail
# because: the clock runs while people are in view, so the robot may never move (local rule)
"""Travel 1 meter down the hallway and stop at the doorway."""

import time
from typing import Final

DISTANCE_M: Final[float] = 1.0
SPEED_MPS: Final[float] = 0.3


def travel() -> None:
    """Travel for the time that the distance takes at nominal speed."""
    start_time: float = time.time()
    while time.time() - start_time < DISTANCE_M / SPEED_MPS:
        if people_observed() or obstacle_observed():
            stop()
        else:
            forward()
    stop()


travel()
