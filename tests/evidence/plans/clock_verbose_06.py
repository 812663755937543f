# skill: drive
# expected: fail
# because: waits two seconds after people have left, but drives while they come back
"""Wait a moment after people have left."""

import time


def cautious(steps: int) -> None:
    """Drive some steps."""
    last_seen = time.time() - 10.0
    done = 0
    while done < steps:
        if people_observed():
            last_seen = time.time()
        if time.time() - last_seen < 0.1 or obstacle_observed():
            stop()
        else:
            forward()
            done += 1
            forward()
    stop()


cautious(5)
