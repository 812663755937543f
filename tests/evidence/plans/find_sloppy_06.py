# skill: find-object
# expected: unsupported
# because: assigns the target after the search has begun
if not people_observed():
    turn_left()
TARGET = "chair"
while not target_observed():
    stop()
