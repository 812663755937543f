# skill: bypass-object
# expected: pass
# because: match on what is seen
pending = False
while True:
    pending = pending or obstacle_observed()
    match (people_observed(), pending):
        case (True, _):
            stop()
        case (False, True):
            turn_right()
            pending = False
        case _:
            forward()
