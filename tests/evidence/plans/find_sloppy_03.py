# skill: find-object
# expected: fail
# because: sleeps while turning
while not target_observed():
    turn_left()
    time.sleep(0.5)
stop()
