# skill: drive
# expected: fail
# because: a pause counts only once it is over, so the time runs out during the first one (local rule)
import time

state = {"start": time.time(), "paused": 0.0, "since": None}
while time.time() - state["start"] - state["paused"] < 0.6:
    if people_observed() or obstacle_observed():
        if state["since"] is None:
            state["since"] = time.time()
        stop()
    else:
        if state["since"] is not None:
            state["paused"] += time.time() - state["since"]
            state["since"] = None
        forward()
stop()
