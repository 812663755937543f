# skill: drive
# expected: pass
# because: own velocity below the bound
steps = 0
while steps < 20:
    if people_observed() or obstacle_observed():
        set_velocity(0.0, 0.0)
    else:
        set_velocity(linear=0.4, angular=0.0)
        steps += 1
set_velocity(0.0, 0.0)
