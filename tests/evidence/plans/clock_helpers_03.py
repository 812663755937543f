# skill: drive
# expected: pass
# because: the helper returns how long it waited
import time

def hold():
    begin = time.time()
    while people_observed() or obstacle_observed():
        stop()
    return time.time() - begin

def leg(action, seconds):
    start = time.time()
    waited = 0.0
    while time.time() - start - waited < seconds:
        if people_observed() or obstacle_observed():
            waited += hold()
        else:
            action()

leg(forward, 0.5)
leg(turn_left, 0.3)
stop()
