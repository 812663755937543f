# skill: drive
# expected: fail
# because: checks obstacles only
n = 30
while n > 0:
  if not obstacle_observed():
    forward(); n = n - 1
  else:
    stop()
stop()
