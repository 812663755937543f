# skill: find-object
# expected: fail
# because: after the target was seen it creeps closer
"""Locate a chair positioned near the doorway and stop 1 meter away."""

TARGET = "chair"
APPROACH_STEPS: int = 10


def safe_forward() -> None:
    """Move one step if that is safe."""
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()


while not target_observed():
    safe_forward()
for _ in range(APPROACH_STEPS):
    safe_forward()
stop()
