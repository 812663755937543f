# skill: drive
# expected: pass
# because: distance by integration of speed over measured time
import time
left, last = 0.3, time.time()
while left > 0:
    blocked = people_observed() or obstacle_observed()
    (stop if blocked else forward)()
    now = time.time()
    if not blocked:
        left -= 0.3 * (now - last)
    last = now
stop()
