# skill: find-object
# expected: fail
# because: looks for the target only every second step
TARGET = "bottle"
tick = 0
while True:
    tick = (tick + 1) % 2
    if tick == 0 and target_observed():
        break
    if people_observed():
        stop()
    elif obstacle_observed():
        turn_left()
    else:
        forward()
stop()
