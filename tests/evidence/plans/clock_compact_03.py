# skill: drive
# expected: pass
# because: seconds as a countdown of floats
left = 1.0
while left > 1e-9:
    if people_observed() or obstacle_observed():
        stop()
        continue
    forward()
    left -= 0.1
stop()
