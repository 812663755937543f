# skill: drive
# expected: unsupported
# because: a function that nothing defines
move_forward(5)
turn_left(90)
stop()
