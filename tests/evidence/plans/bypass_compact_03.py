# skill: bypass-object
# expected: fail
# because: the queue of turns is worked off without looking for people
queue = []
while True:
    if queue:
        queue.pop()()
    elif people_observed():
        stop()
    elif obstacle_observed():
        queue = [turn_left, turn_left]
        turn_left()
    else:
        forward()
