# skill: drive
# expected: pass
# because: a state machine with an enumeration, driving for ever
from enum import Enum

class Mode(Enum):
    DRIVE = 1
    WAIT = 2

mode = Mode.DRIVE
while True:
    if people_observed() or obstacle_observed():
        mode = Mode.WAIT
    else:
        mode = Mode.DRIVE
    if mode == Mode.DRIVE:
        forward()
    else:
        stop()
