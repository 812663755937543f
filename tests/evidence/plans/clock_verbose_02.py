# skill: drive
# expected: pass
# because: monotonic clock, one pause variable at module level
import time

DURATION: float = 0.8
paused: float = 0.0
start: float = time.monotonic()

while time.monotonic() - start - paused < DURATION:
    if people_observed():
        t0: float = time.monotonic()
        while people_observed():
            stop()
        paused = paused + (time.monotonic() - t0)
    elif obstacle_observed():
        t0 = time.monotonic()
        while obstacle_observed():
            stop()
        paused = paused + (time.monotonic() - t0)
    else:
        forward()
stop()
