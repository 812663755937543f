# skill: find-object
# expected: pass
# because: only stands still; the rules allow that
while not target_observed():
    stop()
stop()
