# skill: bypass-object
# expected: fail
# because: bypass manoeuvre of several commands without a look
"""Navigate to the doorway and bypass chairs blocking the path."""


def bypass() -> None:
    """Left, ahead, right, ahead."""
    for action in (turn_left, forward, turn_right, forward):
        for _ in range(3):
            action()


while True:
    if people_observed():
        stop()
    elif obstacle_observed():
        bypass()
    else:
        forward()
