# skill: drive
# expected: fail
# because: gives up when blocked and so may never move (local rule)
"""Drive ahead; abort when something is in the way."""


def attempt(steps: int) -> bool:
    """Return True when all steps were driven."""
    for _ in range(steps):
        if people_observed() or obstacle_observed():
            stop()
            return False
        forward()
    return True


success: bool = attempt(30)
print("success" if success else "aborted")
stop()
