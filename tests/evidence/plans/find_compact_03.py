# skill: find-object
# expected: pass
# because: try/finally stops whatever happens
TARGET = "chair"
try:
    while not target_observed():
        if people_observed():
            stop()
        elif obstacle_observed():
            turn_left()
        else:
            forward()
finally:
    stop()
