# skill: drive
# expected: fail
# because: the last command is forward and goes on for ever
for i in range(100):
    if people_observed():
        stop()
    elif obstacle_observed():
        stop()
    else:
        forward()
