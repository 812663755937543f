# skill: bypass-object
# expected: pass
# because: a first turn satisfies the local rule for ever
while people_observed():
    stop()
turn_left()
while True:
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
