# skill: find-object
# expected: pass
# because: the target is looked for first, in every period
"""Search for a chair and stop once it is detected."""

TARGET = "chair"


def search() -> None:
    """Drive ahead and turn away from obstacles until the target is seen."""
    while not target_observed():
        if people_observed():
            stop()
        elif obstacle_observed():
            turn_left()
        else:
            forward()


def main() -> None:
    """Search, then stay."""
    search()
    stop()


main()
