# skill: bypass-object
# expected: fail
# because: stops for obstacles and never turns
"""Continue moving straight and reroute if an obstacle appears."""

while True:
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
