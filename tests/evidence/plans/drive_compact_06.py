# skill: drive
# expected: pass
# because: square with nested loops and while/else
for side in range(4):
    k = 0
    while k < 12:
        if people_observed() or obstacle_observed():
            stop()
        else:
            forward()
            k += 1
    else:
        t = 0
        while t < 8:
            if people_observed():
                stop()
            else:
                turn_left()
                t += 1
stop()
