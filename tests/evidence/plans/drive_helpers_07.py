# skill: drive
# expected: fail
# because: the second command after a look: forward, then turn_left without a look
def zig():
    while people_observed() or obstacle_observed():
        stop()
    forward()
    turn_left()

for _ in range(5):
    zig()
stop()
