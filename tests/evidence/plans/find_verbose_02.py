# skill: find-object
# expected: fail
# because: people are looked at before the target, so a target behind people is missed
"""Find a backpack near the hallway."""

TARGET = "backpack"


def search() -> None:
    """Search for the backpack."""
    while True:
        if people_observed():
            stop()
        elif target_observed():
            break
        elif obstacle_observed():
            turn_right()
        else:
            forward()


search()
stop()
