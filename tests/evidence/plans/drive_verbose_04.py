# skill: drive
# expected: pass
# because: the clock is stopped while the way is not clear
"""Travel 1 meter down the hallway and stop at the doorway."""

import time


def blocked() -> bool:
    """Return whether the robot must wait."""
    return people_observed() or obstacle_observed()


def travel(distance: float, speed: float = 0.3) -> None:
    """Travel a distance; time spent waiting does not count."""
    start = time.time()
    paused = 0.0
    while (time.time() - start) - paused < distance / speed:
        if blocked():
            pause_start = time.time()
            while blocked():
                stop()
            paused += time.time() - pause_start
        else:
            forward()
    stop()


travel(1.0)
