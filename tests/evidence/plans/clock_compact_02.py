# skill: bypass-object
# expected: pass
# because: turns for a time, watching people
import time
turn_until = None
while True:
    if obstacle_observed() and turn_until is None:
        turn_until = 0.0
    if people_observed():
        stop()
    elif turn_until is not None:
        turn_left()
        turn_until += 0.1
        if turn_until >= 0.3:
            turn_until = None
    else:
        forward()
