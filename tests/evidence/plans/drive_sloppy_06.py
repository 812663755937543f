# skill: drive
# expected: fail
# because: sleeps for the whole distance
forward()
time.sleep(10)
stop()
turn_left()
time.sleep(3)
stop()
