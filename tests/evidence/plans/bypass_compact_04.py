# skill: bypass-object
# expected: pass
# because: a queue that waits for people
queue = []
while True:
    if obstacle_observed() and not queue:
        queue = [turn_left, turn_left]
    if people_observed():
        stop()
    elif queue:
        queue.pop()()
    else:
        forward()
