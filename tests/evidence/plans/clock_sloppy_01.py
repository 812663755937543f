# skill: drive
# expected: fail
# because: sleeps a tenth after every command
t=time.time()
while time.time()-t<2:
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
    time.sleep(.1)
stop()
