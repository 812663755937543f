# skill: bypass-object
# expected: fail
# because: backs off instead of turning
while True:
    if people_observed():
        stop()
    elif obstacle_observed():
        backward()
    else:
        forward()
