# skill: bypass-object
# expected: fail
# because: sleeps after the turn
while True:
    if people_observed():
        stop()
    elif obstacle_observed():
        turn_left()
        time.sleep(0.3)
    else:
        forward()
