# skill: drive
# expected: fail
# because: counts periods in which it waited, and so may never move (local rule)
i=0
while i<50:
    if people_observed() or obstacle_observed(): stop()
    else: forward()
    i+=1
stop()
