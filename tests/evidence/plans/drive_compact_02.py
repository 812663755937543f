# skill: drive
# expected: fail
# because: speed above the bound of rule 3
steps = 0
while steps < 20:
    if people_observed() or obstacle_observed():
        stop()
    else:
        set_velocity(0.6, 0.0)
        steps += 1
stop()
