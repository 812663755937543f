# skill: find-object
# expected: pass
# because: sweep with a look before each turn, leaving both loops by a return
TARGET = "chair"

def clear_step(action):
    if people_observed():
        stop()
    else:
        action()

def sweep(turns):
    for _ in range(turns):
        if target_observed():
            return True
        clear_step(turn_left)
    return False

def search():
    while True:
        if target_observed():
            return
        if obstacle_observed():
            if sweep(6):
                return
        else:
            clear_step(forward)

search()
stop()
