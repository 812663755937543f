# skill: find-object
# expected: fail
# because: a sweep of several turns without a look
TARGET = "chair"

def sweep():
    for _ in range(5):
        turn_left()

while not target_observed():
    if people_observed():
        stop()
    elif obstacle_observed():
        sweep()
    else:
        forward()
stop()
