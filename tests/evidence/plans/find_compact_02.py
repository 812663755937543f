# skill: find-object
# expected: fail
# because: two commands between two looks for the target
TARGET = "chair"
while True:
    for action in (forward, turn_left):
        if people_observed() or (action is forward and obstacle_observed()):
            stop()
        else:
            action()
    if target_observed():
        break
stop()
