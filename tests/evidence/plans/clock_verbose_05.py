# skill: drive
# expected: pass
# because: the deadline moves with the pauses
import time

deadline = time.time() + 1.0
last = time.time()
while time.time() < deadline:
    now = time.time()
    if people_observed() or obstacle_observed():
        stop()
        deadline += time.time() - now
    else:
        forward()
stop()
