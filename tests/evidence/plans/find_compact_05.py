# skill: find-object
# expected: fail
# because: drives on after the search has ended without success
TARGET = "backpack"
found = False
for step in range(10):
    if target_observed():
        found = True
        break
    if people_observed() or obstacle_observed():
        stop()
    else:
        forward()
if not found:
    forward()
stop()
