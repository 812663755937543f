# skill: drive
# expected: fail
# because: waits half a second after people have left: those who come back every few periods keep it for ever (local rule)
import time

last_seen = time.time() - 10.0
while True:
    if people_observed():
        last_seen = time.time()
        stop()
    elif obstacle_observed() or time.time() - last_seen < 0.5:
        stop()
    else:
        forward()
