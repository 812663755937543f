# skill: find-object
# expected: pass
# because: legs and looks around with a modulo counter
"""Find an object with a sweep after each leg."""

TARGET = "person"
LEG_STEPS: int = 20
SWEEP_STEPS: int = 12


def sweep_or_drive(phase: int) -> int:
    """Execute one step of the phase and return the next phase."""
    if people_observed():
        stop()
        return phase
    if phase < LEG_STEPS and not obstacle_observed():
        forward()
    else:
        turn_left()
    return (phase + 1) % (LEG_STEPS + SWEEP_STEPS)


phase: int = 0
while not target_observed():
    phase = sweep_or_drive(phase)
stop()
