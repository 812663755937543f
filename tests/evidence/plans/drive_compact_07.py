# skill: drive
# expected: fail
# because: break ends the drive at the first obstacle, before it has moved (local rule)
for _ in range(40):
    if obstacle_observed():
        break
    if people_observed():
        stop()
        continue
    forward()
stop()
