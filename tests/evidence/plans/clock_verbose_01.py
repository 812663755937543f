# skill: drive
# expected: pass
# because: elapsed time without the pauses, in a helper with defaults
"""Drive for a time, not counting pauses."""

import time


def drive_for(duration_s: float = 1.0) -> None:
    """Drive for a duration; waiting does not count."""
    start: float = time.time()
    paused: float = 0.0
    while (time.time() - start) - paused < duration_s:
        if people_observed() or obstacle_observed():
            pause_start: float = time.time()
            while people_observed() or obstacle_observed():
                stop()
            paused += time.time() - pause_start
        else:
            forward()
    stop()


drive_for()
