# skill: bypass-object
# expected: fail
# because: the memory is cleared before the turn was possible
pending = False
while True:
    pending = obstacle_observed()
    if people_observed():
        stop()
    elif pending:
        turn_right()
    else:
        forward()
