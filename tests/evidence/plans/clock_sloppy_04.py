# skill: drive
# expected: pass
# because: measures and forgets
import time
while True:
    t0 = time.time()
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
    dt = time.time() - t0
    rate = 1.0 / dt if dt > 0 else 0.0
