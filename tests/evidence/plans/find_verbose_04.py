# skill: find-object
# expected: pass
# because: a class with a found flag that is never reset
"""Search the room for a trash bin and stop when found."""

TARGET = "trash bin"


class Searcher:
    """Searches until the target was seen once."""

    def __init__(self) -> None:
        self.found: bool = False

    def look(self) -> None:
        """Update the flag."""
        if target_observed():
            self.found = True

    def step(self) -> None:
        """Execute one period."""
        self.look()
        if self.found or people_observed():
            stop()
        elif obstacle_observed():
            turn_left()
        else:
            forward()


searcher = Searcher()
while True:
    searcher.step()
