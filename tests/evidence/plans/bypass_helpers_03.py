# skill: bypass-object
# expected: fail
# because: ends after its distance and answers no obstacle afterwards
pending = False
left = 20
while left > 0:
    if obstacle_observed():
        pending = True
    if people_observed():
        stop()
    elif pending:
        turn_left()
        pending = False
    else:
        forward()
        left -= 1
stop()
