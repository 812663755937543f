# skill: drive
# expected: fail
# because: checks people only
while True:
  if people_observed():
    stop()
  else:
    forward()
