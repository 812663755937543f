# skill: find-object
# expected: pass
# because: the order of searching is a list of functions
TARGET = "backpack"

def choose():
    if people_observed():
        return stop
    if obstacle_observed():
        return turn_left
    return forward

while True:
    if target_observed():
        break
    choose()()
stop()
