# skill: drive
# expected: pass
# because: dispatch through a dictionary of functions
ACTIONS = {"forward": forward, "left": turn_left, "right": turn_right}

def blocked(name):
    return people_observed() or (name == "forward" and obstacle_observed())

def execute(name, steps):
    remaining = steps
    while remaining:
        if blocked(name):
            stop()
        else:
            ACTIONS[name]()
            remaining -= 1

for name, steps in [("forward", 25), ("right", 31), ("forward", 15)]:
    execute(name, steps)
stop()
