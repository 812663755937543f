# skill: find-object
# expected: fail
# because: the inner wait for people does not look for the target
TARGET = "bottle"

def wait_for_people():
    while people_observed():
        stop()

while not target_observed():
    wait_for_people()
    if obstacle_observed():
        turn_left()
    else:
        forward()
stop()
