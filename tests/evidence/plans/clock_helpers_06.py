# skill: find-object
# expected: pass
# because: looks for the target all the time, stops when the time is up
import time

TARGET = "bottle"
start = time.time()
while time.time() - start < 1.0:
    if target_observed():
        break
    if people_observed():
        stop()
    elif obstacle_observed():
        turn_left()
    else:
        forward()
stop()
