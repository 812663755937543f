# skill: bypass-object
# expected: fail
# because: turns when an obstacle is seen even in front of people
"""Reach the hallway entrance while avoiding chairs or boxes."""


def avoid() -> None:
    """Turn aside until the way is free."""
    while obstacle_observed():
        turn_left()


while True:
    if people_observed():
        stop()
    else:
        avoid()
        if people_observed():
            stop()
        else:
            forward()
