# skill: bypass-object
# expected: pass
# because: turns once at the start, so the local rule holds without an obstacle
"""Drive in circles, waiting for people."""


def wait_for_people() -> None:
    """Stand still while people are in view."""
    while people_observed():
        stop()


while True:
    wait_for_people()
    turn_left()
