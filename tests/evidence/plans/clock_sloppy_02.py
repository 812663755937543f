# skill: drive
# expected: pass
# because: restarts its clock after every wait, and so drives a whole leg at last
t = time.time()
while time.time() - t < 0.5:
    if people_observed() or obstacle_observed():
        stop()
        t = time.time()
    else:
        forward()
stop()
