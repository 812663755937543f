# skill: find-object
# expected: fail
# because: forgets the target when it is out of view
"""Navigate until a bottle is observed."""

TARGET = "bottle"

while True:
    if target_observed() or people_observed():
        stop()
    elif obstacle_observed():
        turn_left()
    else:
        forward()
