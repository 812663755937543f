# skill: drive
# expected: fail
# because: does not look for obstacles
def step(action):
    if people_observed():
        stop()
        return False
    action()
    return True

done = 0
while done < 10:
    if step(forward):
        done += 1
stop()
