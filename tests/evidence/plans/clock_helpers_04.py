# skill: drive
# expected: pass or unknown
# because: decides by the time of day what to do, which never changes what is safe
import time

while True:
    phase = int(time.time()) % 2
    if people_observed() or obstacle_observed():
        stop()
    elif phase == 0:
        forward()
    else:
        turn_left()
