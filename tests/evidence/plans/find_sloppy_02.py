# skill: find-object
# expected: pass
# because: never drives forward, only turns
while not target_observed():
    if people_observed(): stop()
    else: turn_left()
stop()
