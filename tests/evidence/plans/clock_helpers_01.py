# skill: drive
# expected: pass
# because: nested functions share the paused time
import time

def drive_straight(distance, speed=0.3):
    paused = 0.0
    start = time.time()

    def wait():
        nonlocal paused
        begin = time.time()
        while people_observed() or obstacle_observed():
            stop()
        paused += time.time() - begin

    while time.time() - start - paused < distance / speed:
        if people_observed() or obstacle_observed():
            wait()
        else:
            forward()
    stop()

drive_straight(0.3)
