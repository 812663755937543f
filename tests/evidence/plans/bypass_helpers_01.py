# skill: bypass-object
# expected: pass
# because: turn in place for as long as the obstacle is there, memory for people
pending = False

def note():
    global pending
    if obstacle_observed():
        pending = True

def react():
    global pending
    if people_observed():
        stop()
    elif pending:
        turn_right()
        pending = False
    else:
        forward()

while True:
    note()
    react()
