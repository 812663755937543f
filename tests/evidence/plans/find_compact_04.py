# skill: find-object
# expected: pass
# because: at most so many steps, then stops for good
TARGET = "backpack"
for step in range(60):
    if target_observed():
        break
    if people_observed():
        stop()
    elif obstacle_observed():
        turn_right()
    else:
        forward()
stop()
