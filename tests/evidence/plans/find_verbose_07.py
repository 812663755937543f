# skill: find-object
# expected: fail
# because: the first command comes before the first look for the target
"""Search for at most three seconds."""

import time

TARGET = "chair"
TIMEOUT_S: float = 3.0

start: float = time.time()
found: bool = False
while not found and time.time() - start < TIMEOUT_S:
    if people_observed():
        stop()
    elif obstacle_observed():
        turn_left()
    else:
        forward()
    found = target_observed()
print("found" if found else "not found")
stop()
