# skill: bypass-object
# expected: pass
# because: bypass manoeuvre with a look before every command
"""Navigate around a chair and continue to move ahead."""

pending: bool = False


def guarded(action, steps: int) -> None:
    """Execute an action for some periods, waiting for what is in the way."""
    done: int = 0
    while done < steps:
        if people_observed():
            stop()
        elif action is forward and obstacle_observed():
            turn_left()
        else:
            action()
            done += 1


while True:
    guarded(turn_left, 3)
    guarded(forward, 4)
    guarded(turn_right, 3)
