# skill: find-object
# expected: pass
# because: remembers what it has seen in a list
TARGET = "person"
seen = []
while not seen:
    if target_observed():
        seen.append("person")
        stop()
    elif people_observed():
        stop()
    elif obstacle_observed():
        turn_right()
    else:
        forward()
stop()
