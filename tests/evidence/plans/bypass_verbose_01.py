# skill: bypass-object
# expected: pass
# because: remembers an obstacle until it could turn, and watches for ever
"""Move forward for 1 meter while avoiding obstacles."""

STEPS: int = 33


class Avoider:
    """Drives ahead and turns aside once for each obstacle."""

    def __init__(self, steps: int) -> None:
        self.steps_left: int = steps
        self.pending: bool = False

    def step(self) -> None:
        """Execute one control period."""
        if obstacle_observed():
            self.pending = True
        if people_observed():
            stop()
        elif self.pending:
            turn_left()
            self.pending = False
        elif self.steps_left > 0:
            forward()
            self.steps_left -= 1
        else:
            stop()


avoider = Avoider(STEPS)
while True:
    avoider.step()
