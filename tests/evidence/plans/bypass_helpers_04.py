# skill: bypass-object
# expected: pass
# because: alternates the side with a counter
side = 0
pending = False

def turn():
    global side
    side = 1 - side
    if side:
        turn_left()
    else:
        turn_right()

while True:
    pending = pending or obstacle_observed()
    if people_observed():
        stop()
    elif pending:
        turn()
        pending = False
    else:
        forward()
