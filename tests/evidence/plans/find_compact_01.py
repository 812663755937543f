# skill: find-object
# expected: pass
# because: walrus and conditional expression
TARGET = "bottle"
while not (found := target_observed()):
    if people_observed():
        stop()
    else:
        turn_left() if obstacle_observed() else forward()
stop()
