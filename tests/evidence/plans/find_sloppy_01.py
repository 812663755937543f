# skill: find-object
# expected: fail
# because: never looks for obstacles
while not target_observed():
    if people_observed(): stop()
    else: forward()
stop()
