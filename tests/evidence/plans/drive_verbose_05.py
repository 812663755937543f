# skill: drive
# expected: pass
# because: a class with state, one look per command
"""Drive in legs using a small controller class."""

from typing import List, Tuple


class RouteController:
    """Executes legs of (steps, direction)."""

    def __init__(self, legs: List[Tuple[int, str]]) -> None:
        self.legs = legs
        self.done = False

    def safe(self) -> bool:
        """Whether both detectors are quiet."""
        if people_observed():
            return False
        return not obstacle_observed()

    def command(self, name: str) -> None:
        """Execute one control period of the named command."""
        if name == "forward":
            forward()
        elif name == "left":
            turn_left()
        else:
            turn_right()

    def run(self) -> None:
        """Run all legs."""
        for steps, name in self.legs:
            remaining = steps
            while remaining > 0:
                if self.safe():
                    self.command(name)
                    remaining -= 1
                else:
                    stop()
        self.done = True
        stop()


controller = RouteController([(20, "forward"), (10, "right"), (10, "forward")])
controller.run()
