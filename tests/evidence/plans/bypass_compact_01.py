# skill: bypass-object
# expected: pass
# because: one expression decides
hold = False
while True:
    hold = hold or obstacle_observed()
    action = stop if people_observed() else turn_left if hold else forward
    hold = hold and action is stop
    action()
