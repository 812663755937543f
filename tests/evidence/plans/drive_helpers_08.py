# skill: drive
# expected: pass
# because: early return and a flag
def drive_step():
    if people_observed():
        stop()
        return False
    if obstacle_observed():
        stop()
        return False
    forward()
    return True

arrived = False
count = 0
while not arrived:
    if drive_step():
        count += 1
    arrived = count >= 50
stop()
