# skill: drive
# expected: fail
# because: a deadline for everything: it may wait all the time (local rule)
import time

deadline = time.time() + 1.5
while time.time() < deadline:
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
stop()
