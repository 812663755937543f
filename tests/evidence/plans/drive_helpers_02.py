# skill: drive
# expected: fail
# because: waits once and then drives a whole leg blindly
def wait_until_clear():
    while people_observed() or obstacle_observed():
        stop()

def leg(steps):
    wait_until_clear()
    for _ in range(steps):
        forward()

leg(20)
leg(20)
stop()
