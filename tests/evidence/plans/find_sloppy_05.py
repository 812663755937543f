# skill: find-object
# expected: unsupported
# because: calls a detector that does not exist
while not detect("chair"):
    forward()
stop()
