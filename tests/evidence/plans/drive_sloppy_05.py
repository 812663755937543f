# skill: drive
# expected: fail
# because: never moves
stop()
