# skill: bypass-object
# expected: fail
# because: forward after a turn without a new look
def avoid():
    turn_left()
    forward()

while True:
    if people_observed():
        stop()
    elif obstacle_observed():
        avoid()
    else:
        forward()
