# skill: drive
# expected: pass
# because: adds up the time of its own motion
import time

moved: float = 0.0
while moved < 1.0:
    if people_observed() or obstacle_observed():
        stop()
    else:
        before: float = time.time()
        forward()
        moved += time.time() - before
stop()
