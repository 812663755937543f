# skill: drive
# expected: pass
# because: one line per branch, drives for ever when clear
while 1:
    stop() if people_observed() or obstacle_observed() else forward()
