# skill: bypass-object
# expected: fail
# because: an obstacle in front of people is forgotten; obstacles after arrival are not answered
"""Travel 4 meters while safely avoiding detected obstacles."""


def travel(steps: int) -> None:
    """Travel a number of steps."""
    done: int = 0
    while done < steps:
        if people_observed():
            stop()
        elif obstacle_observed():
            turn_right()
        else:
            forward()
            done += 1
    stop()


travel(30)
