# skill: find-object
# expected: pass
# because: search step as a function that returns whether it found the target
TARGET = "bottle"

def step():
    if target_observed():
        return True
    if people_observed():
        stop()
    elif obstacle_observed():
        turn_right()
    else:
        forward()
    return False

found = False
while not found:
    found = step()
stop()
